"""Parts of the documentation site: Sphinx extensions, and scripts that write pages."""
