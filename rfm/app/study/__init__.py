"""Studies: one case with many values of its keys, run here, in processes of this computer or on a cluster."""
