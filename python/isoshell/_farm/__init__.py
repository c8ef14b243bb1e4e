"""Many assets, one mesh each, over the workers of a Dask cluster: the command `isoshell farm`."""
