"""The scene language: documents, their fields, specimens and scenes."""
