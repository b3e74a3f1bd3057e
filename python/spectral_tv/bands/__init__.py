"""The settings of a decomposition into bands, and the gains of these."""
