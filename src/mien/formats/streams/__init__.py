"""Datagrams in which faces travel between programs; a protocol a module. Bytes in, frames out."""
