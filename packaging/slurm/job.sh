#!/bin/bash
# A run that takes longer than the queue lets a job live: it ends before the limit, queues itself again, and goes on.
#
#     sbatch packaging/slurm/job.sh scene.toml [--set mesh.size_body=0.05 …]
#
# Change the lines of #SBATCH, and `launch`, to what your cluster has.
#SBATCH --job-name=rigidfluid
#SBATCH --ntasks=64
#SBATCH --cpus-per-task=1
#SBATCH --hint=nomultithread
#SBATCH --time=24:00:00
# SIGTERM to all processes ten minutes before; a run ends at its next exchange, so a step must take less.
#SBATCH --signal=TERM@600
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail

scene=${1:?which scene? As in: sbatch packaging/slurm/job.sh scene.toml}
shift
out=out/$(basename "$scene" .toml)
# Open MPI 5 knows PMIx alone; `srun --mpi=list` says what Slurm has. In an image: launch=(srun … apptainer exec rigidfluid.sif)
launch=(srun --mpi=pmix)
export OMP_NUM_THREADS=1 # or BLAS of all processes fights for the same cores

mkdir -p "$out"
resume=()
[[ ! -e $out/state.h5 ]] || resume=(--resume)
checkpoint_time() { stat --format %Y "$out/state.h5" 2>/dev/null || echo 0; }
before=$(checkpoint_time)

status=0
"${launch[@]}" rigidfluid run "$scene" --out "$out" --set fluid.backend=dolfinx "$@" "${resume[@]}" || status=$?

case $status in
130 | 143) # interrupted: at a step, or while it started
    if [[ $(checkpoint_time) == "$before" ]]; then
        echo "job.sh: no checkpoint was written before the time limit; take a shorter output.every or a longer --time" >&2
        exit 1
    fi
    scontrol requeue "$SLURM_JOB_ID"
    ;;
*) exit "$status" ;;
esac
