//! The error-state filter behind a C header.
