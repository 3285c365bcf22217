"""Pictures in and out: videos, folders, cameras."""
