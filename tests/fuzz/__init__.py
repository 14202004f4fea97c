"""The fuzzer's seeds and words; its targets in C are beside it."""
