//! Units as people write them; filled in by units parsing.
