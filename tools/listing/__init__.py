"""The icon and the pictures of the extension's page on extensions.blender.org."""
