#!/usr/bin/env bash
# scratch_slurm.sh DIR NODES CPUS: a Slurm cluster of this machine alone, NODES nodes of CPUS processors each, with its
# files in DIR. Prints DIR/slurm.conf (for SLURM_CONF) once the nodes are idle, then serves until its standard input ends.
# Only root can start it; needs Debian's slurm-wlm and munge (tools/install_packages.sh --cluster).
set -euo pipefail

if [[ $# -ne 3 ]]; then
  echo "scratch_slurm.sh: give folder, number of nodes, processors of each: scratch_slurm.sh /tmp/slurm 2 1" >&2
  exit 2
fi
dir=$(realpath "$1")
nodes=$2
cpus=$3
if [[ "$(id -u)" != "0" ]]; then
  echo "scratch_slurm.sh: only root can start the daemons of Slurm" >&2
  exit 2
fi
for program in slurmctld slurmd munged; do
  if ! PATH="$PATH:/usr/sbin" command -v "$program" >/dev/null; then
    echo "scratch_slurm.sh: no $program: install slurm-wlm and munge (tools/install_packages.sh --cluster)" >&2
    exit 2
  fi
done
export PATH="$PATH:/usr/sbin"

mkdir -p "$dir/state" "$dir/spool"
host=$(hostname)
# Ports of this process, so that several clusters can run.
port=$((20000 + $$ % 20000))
cat >"$dir/slurm.conf" <<END
ClusterName=scratch
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge.socket
CredType=cred/munge
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool/%n
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd-%n.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
SchedulerParameters=sched_interval=1,bf_interval=1
END
for ((i = 1; i <= nodes; ++i)); do
  echo "NodeName=node$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + i)) CPUs=$cpus State=UNKNOWN"
done >>"$dir/slurm.conf"
echo "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP" >>"$dir/slurm.conf"
export SLURM_CONF=$dir/slurm.conf

pids=()
cleanup() {
  kill "${pids[@]}" 2>/dev/null || true
  wait 2>/dev/null || true
}
trap cleanup EXIT
trap 'exit 1' HUP INT TERM
start() {
  "$@" </dev/null >>"$dir/daemons.log" 2>&1 &
  pids+=($!)
}

head -c 1024 /dev/urandom >"$dir/munge.key"
chmod 600 "$dir/munge.key"
start munged --foreground --force --key-file="$dir/munge.key" --socket="$dir/munge.socket" --pid-file="$dir/munge.pid" \
  --log-file="$dir/munge.log" --seed-file="$dir/munge.seed"
start slurmctld -D -i
for ((i = 1; i <= nodes; ++i)); do
  start slurmd -D -N "node$i"
done
for ((i = 0; ; ++i)); do
  [[ "$(sinfo --noheader --Node --states=idle --format=%N 2>/dev/null | wc -l)" == "$nodes" ]] && break
  if ((i >= 300)); then
    tail -n 20 "$dir"/*.log >&2
    exit 1
  fi
  sleep 0.2
done
echo "$dir/slurm.conf"
cat >/dev/null
