"""The scene language: specimens and scenes as people write them."""
