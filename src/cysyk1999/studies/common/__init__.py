"""What several studies share: meshes of other elements, scenes in the words of documents, plans."""
