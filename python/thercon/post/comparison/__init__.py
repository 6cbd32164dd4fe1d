"""post/compare: results against each other and against those of other programs."""
