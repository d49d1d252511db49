"""What is felt: the mechanical state at material points under the skin, where receptors sit."""
