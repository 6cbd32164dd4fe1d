#!/usr/bin/env bash
# Row SLURM_ARRAY_TASK_ID of values.csv as a task of a Slurm job array; in this folder:
#
#    sbatch --array=1-200%50 array.sh
#
#SBATCH --job-name=sweep
#SBATCH --time=00:05:00
#SBATCH --mem=500M
#SBATCH --output=array-%A_%a.log
set -euo pipefail

line=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" values.csv)
IFS=, read -r run gap hot <<<"${line%$'\r'}"
[[ -n $run ]] || { echo "values.csv has no row $SLURM_ARRAY_TASK_ID" >&2; exit 1; }
exec "${THERCON:-thercon}" run joint.inp --quiet --jobs 1 --set "gap=$gap" --set "hot=$hot" --out "runs/$run"
