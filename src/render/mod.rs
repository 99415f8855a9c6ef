//! Shaded pictures of meshes, in software.
