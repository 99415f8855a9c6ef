//! Hierarchies of axis-aligned boxes over triangles, and the queries that walk them.
