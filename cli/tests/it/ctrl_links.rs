//! Links of live sessions that fail or are not ready: what is said, and how soon.
