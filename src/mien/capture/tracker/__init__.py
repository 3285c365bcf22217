"""The tracker after [C]: head pose and shape from the picture of the face itself."""
