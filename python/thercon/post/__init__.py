"""Pictures of thercon results. Reads the HDF5 result file only."""
