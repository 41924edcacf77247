//! Homotopy continuation.
