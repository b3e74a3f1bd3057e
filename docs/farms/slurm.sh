#!/bin/bash
# Filters all files of a folder in shares, each a task of a job array. It may run again: what is there is
# passed over.
#
#   sbatch --array=1-16 slurm.sh FOLDER RESULTS OPTION...
#
#SBATCH --job-name=spectral-tv
#SBATCH --cpus-per-task=4
#SBATCH --mem=16G
#SBATCH --time=04:00:00
#SBATCH --signal=B:TERM@60
set -euo pipefail

inputs=$1 output=$2
mkdir -p "$output"
# An exec, so that SLURM's signals reach the program: it ends at once, and leaves no half of a file.
exec spectral-tv decompose "$inputs" -o "$output" "${@:3}" \
  --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --skip-existing \
  --jobs "${SLURM_CPUS_PER_TASK:-1}" --report "$output/report.jsonl"
