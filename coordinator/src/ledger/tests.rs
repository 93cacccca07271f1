//! Any interleaving of events gives the same result.
