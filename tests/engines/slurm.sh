#!/bin/bash
# A sweep over every float as a Slurm job array on this machine alone: munged, slurmctld and slurmd are started in a
# temporary folder, a job array does eight shards of which two are killed and requeued, and the joined result is
# compared with that of one run, byte for byte. Ends with 77 (skipped) where Slurm is not installed or not allowed.
#
#     tests/engines/slurm.sh PROGRAM SCRIPT [SWEEP [SHARDS [FORMS]]]
set -u
program=$(realpath "$1") script=$(realpath "$2")
sweep=${3:-} shards=${4:-8} forms=${5:-sphere.schoolbook}
PATH=$PATH:/usr/sbin
skip() { echo "skipped: $*"; exit 77; }
for tool in munged slurmctld slurmd sbatch scontrol squeue; do
    command -v "$tool" >/dev/null || skip "$tool is not installed (Debian: slurmctld slurmd slurm-client munge)"
done
((EUID == 0)) || skip "slurmd wants to be root"

work=$(mktemp -d)
host=$(hostname -s)
stop() {
    for name in slurmd slurmctld munged; do
        [[ -s $work/$name.pid ]] && kill "$(<"$work/$name.pid")" 2>/dev/null
    done
    for _ in $(seq 50); do
        alive=0
        for name in slurmd slurmctld munged; do
            [[ -s $work/$name.pid ]] && kill -0 "$(<"$work/$name.pid")" 2>/dev/null && alive=1
        done
        ((alive)) || break
        sleep 0.1
    done
    [[ -n ${KEEP-} ]] && echo "kept: $work" || rm -rf "$work"
}
trap stop EXIT
fail() { echo "FAILED: $*"; tail -n 15 "$work"/*.log "$work"/task-*.txt 2>/dev/null; exit 1; }

# Ports that nobody uses: Slurm's own, moved by this process's number.
port=$((20000 + $$ % 20000))
mkdir "$work/state" "$work/spool" "$work/munge"
chmod 755 "$work" "$work/munge"
dd if=/dev/urandom of="$work/munge/key" bs=128 count=1 2>/dev/null
chmod 600 "$work/munge/key"
cat >"$work/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket,cred_expire=5
CredType=cred/munge
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0,requeue_delay=0
ReturnToService=2
MinJobAge=3600
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
# slurmd reads a cgroup plugin in any case; the first of these two makes no cgroups of its own while no other plugin
# asks it for them, so that a container without writable cgroups will do.
echo "CgroupPlugin=cgroup/v1" >"$work/cgroup.conf"
export SLURM_CONF=$work/slurm.conf

munged --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munged.pid" \
    --log-file="$work/munged.log" --seed-file="$work/munge/seed" --force 2>/dev/null || skip "munged does not start"
slurmctld -f "$SLURM_CONF" -c 2>/dev/null || skip "slurmctld does not start: $(tail -n 1 "$work/slurmctld.log")"
slurmd -f "$SLURM_CONF" 2>/dev/null || skip "slurmd does not start: $(tail -n 1 "$work/slurmd.log")"
for _ in $(seq 100); do
    [[ $(sinfo -h -o %T 2>/dev/null) == idle ]] && break
    sleep 0.2
done
[[ $(sinfo -h -o %T) == idle ]] || skip "the node does not come up: $(sinfo -h -o '%T %E')"
echo "Slurm $(slurmctld -V | cut -d' ' -f2) runs on $host"

if [[ -z $sweep ]]; then
    sweep=$work/s.toml
    cat >"$sweep" <<'TOML'
schema = "lostbits-sweep/1"
title  = "Away from a unit sphere"
source = "-"

[axis]
name    = "distance"
unit    = "r"
spacing = "every_float"
set     = "ray.origin.z"
from    = "0x1p0"
to      = "0x1p40"

[[ray]]
name      = "beside"
origin    = [0.75, 0.75, 0]
direction = [0, 0, -1]

[sphere]
centre = [0, 0, 0]
radius = 1
TOML
fi

export LOSTBITS=$program FORMS=$forms
cd "$work" || exit 1
begin=$(date +%s)
job=$(sbatch --parsable --array="1-$shards" -o "$work/task-%a.txt" "$script" "$sweep" "$work/parts") || fail sbatch
echo "job $job: $shards shards"

# Two that are running are requeued: Slurm kills them and starts them again.
killed=()
for _ in $(seq 6000); do
    for task in $(squeue -h -r -j "$job" -t RUNNING -o %K 2>/dev/null); do
        [[ " ${killed[*]-} " == *" $task "* || -e $work/parts/shard-$task-of-$shards/shard.state ]] && continue
        [[ -d $work/parts/shard-$task-of-$shards ]] || continue
        scontrol requeue "${job}_$task" 2>/dev/null || continue
        killed+=("$task")
        echo "killed and requeued: shard $task"
        ((${#killed[@]} == 2)) && break 2
    done
    [[ -z $(squeue -h -j "$job" 2>/dev/null) ]] && break
    sleep 0.1
done
((${#killed[@]} == 2)) || fail "only ${#killed[@]} shards could be killed: the machine is faster than the test foresees"
while [[ -n $(squeue -h -j "$job" -t PENDING,RUNNING,COMPLETING 2>/dev/null) ]]; do sleep 0.3; done
echo "all shards have ended after $(($(date +%s) - begin)) s"
for task in "${killed[@]}"; do
    restarts=$(scontrol show job "${job}_$task" | grep -o 'Restarts=[0-9]*')
    [[ $restarts == Restarts=0 || -z $restarts ]] && fail "shard $task was not started again"
    echo "shard $task: $restarts"
done

"$program" -q merge "$work/parts" -o "$work/joined" || fail "the shards do not join"
begin=$(date +%s)
"$program" -q sweep "$sweep" -i "$forms" -o "$work/whole" || fail "the whole run"
echo "the whole run took $(($(date +%s) - begin)) s"
diff -r "$work/whole" "$work/joined" || fail "the joined result is another one"
"$program" -q diff --strict "$work/whole" "$work/joined" || fail "lostbits diff"
echo "the joined result is that of one run, byte for byte:"
(cd "$work/joined" && find . -type f -exec sha256sum {} +)
