#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A sweep on many machines, for real: GNU parallel over ssh, and a job array of a one-node Slurm with munge, all on loopback, started and ended here. Workers are killed while
they work; what comes out must be the bytes of one uninterrupted run, and nothing judged twice but the point that a killed worker was at. Skipped, saying so, only where Debian's packages cannot be installed."""
import contextlib
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")) / "spantex"
JOBS, KILLS = 4, 3
SPEC = {"name": "machines", "size": "320x192", "base": {"profile": "default"}, "scenes": ["tilted"], "measures": ["picture", "twin", "coordinates", "cost"],
        "parts": [{"name": "grid", "axes": {"filter": ["trilinear", "aniso"], "subtexel_bits": {"from": 1, "to": 8}, "level_bits": [2, 4, 8]}}]}


def run(*command, **more):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=120, **more)


def checked(*command, **more):
    done = run(*command, **more)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def wait_for(what, seconds, probe):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if probe():
            return
        time.sleep(0.1)
    raise AssertionError(f"no {what} after {seconds} s")


@contextlib.contextmanager
def daemon(log, *command, **more):
    with open(log, "ab") as out:
        process = subprocess.Popen([str(c) for c in command], stdout=out, stderr=out, stdin=subprocess.DEVNULL, **more)
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def workers(folder):
    """Process by record, of our binary's that write into the folder, which nobody else has."""
    found = {}
    for place in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            line = (place / "cmdline").read_bytes().decode(errors="replace").split("\0")
            if line[0] == str(BINARY.resolve()):
                found |= {part: int(place.name) for part in line if part.startswith(str(folder))}
    return found


def kill_some(folder, still_running):
    """Kills workers in the midst of their records, none twice (a job is tried three times), while the sweep runs; returns how many. A record's worker lives for seconds,
    so that twenty looks a second find it however busy the machine is."""
    killed, asked = set(), 0.0
    while len(killed) < KILLS:
        time.sleep(0.05)
        if time.monotonic() > asked + 1:
            if not still_running():
                break
            asked = time.monotonic()
        for record, pid in workers(folder).items():
            with contextlib.suppress(OSError):
                if record not in killed and pathlib.Path(record).read_bytes().count(b"\n") >= 1 + len(killed):
                    os.kill(pid, signal.SIGKILL)
                    killed.add(record)
    return len(killed)


def check_result(folder, expected, killed, what):
    assert killed > 0, f"{what}: no worker was there to be killed"
    checked(folder / "merge.sh")
    assert (folder / "all.csv").read_bytes() == expected, f"{what}: merged rows are not those of one run"
    print(f"{what}: {JOBS} jobs, {killed} workers killed, the rows of one run")


def check_merge_refusals(folder, spec):
    first, out = folder / "1.csv", folder / "refused.csv"
    records = [folder / f"{k}.csv" for k in range(1, JOBS + 1)]
    for given, reason in ((records[1:], "points are missing"), ([*records, first], "already")):
        done = run(BINARY, "sweep", spec, "--merge", *given, "--out", out)
        assert done.returncode == 2 and reason in done.stderr and done.stderr.count("\n") == 1 and not out.exists(), done.stderr


def over_ssh(place, spec, expected):
    folder, port = place / "parallel", free_port()
    folder.mkdir()
    checked("ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", place / "host")
    checked("ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", place / "user")
    (place / "authorized").write_text((place / "user.pub").read_text())
    pathlib.Path("/run/sshd").mkdir(exist_ok=True)
    (place / "sshd_config").write_text(f"Port {port}\nListenAddress 127.0.0.1\nHostKey {place}/host\nAuthorizedKeysFile {place}/authorized\nStrictModes no\n"
                                       "UsePAM no\nPasswordAuthentication no\nPidFile none\nPermitRootLogin prohibit-password\n")
    user = checked("id", "-un").strip()
    login = (f"ssh -p {port} -i {place}/user -o IdentitiesOnly=yes -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null -o LogLevel=ERROR {user}@127.0.0.1")
    (place / "hosts").write_text(f"2/{login}\n")
    checked(ROOT / "tools/sweep_jobs", spec, "--jobs", JOBS, "--folder", folder, "--binary", BINARY)
    with daemon(place / "sshd.log", "/usr/sbin/sshd", "-D", "-e", "-f", place / "sshd_config"):
        wait_for("ssh", 20, lambda: run(*login.split(), "true").returncode == 0)
        with open(place / "parallel.log", "wb") as log, subprocess.Popen([str(folder / "parallel.sh"), "--sshloginfile", str(place / "hosts")], stdout=log, stderr=log) as sweep:
            killed = kill_some(folder, lambda: sweep.poll() is None)
            sweep.wait(120)
        assert sweep.returncode == 0, f"parallel: exit code {sweep.returncode}\n{(place / 'parallel.log').read_text()}"
    check_result(folder, expected, killed, "GNU parallel over ssh")
    check_merge_refusals(folder, spec)


SLURM_CONF = """ClusterName=spantex
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={controller}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={place}/munge/socket
CryptoType=crypto/munge
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SchedulerType=sched/builtin
ReturnToService=2
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def with_slurm(place, spec, expected):
    folder, munge = place / "slurm", place / "munge"
    for made in (folder, munge, place / "state", place / "spool"):
        made.mkdir()
    munge.chmod(0o755)
    key = munge / "key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o600)
    host = socket.gethostname().split(".")[0]
    conf = place / "slurm.conf"
    conf.write_text(SLURM_CONF.format(host=host, user=checked("id", "-un").strip(), controller=free_port(), node=free_port(), place=place, cpus=os.cpu_count()))
    environment = dict(os.environ, SLURM_CONF=str(conf))
    checked(ROOT / "tools/sweep_jobs", spec, "--jobs", JOBS, "--folder", folder, "--binary", BINARY)
    munged = ["munged", "--foreground", "--force", f"--socket={munge}/socket", f"--key-file={key}", f"--log-file={munge}/log", f"--pid-file={munge}/pid", f"--seed-file={munge}/seed"]
    slurm_log = place / "slurm.log"
    with daemon(munge / "out", *munged):
        wait_for("munge", 20, lambda: (munge / "socket").exists())
        with daemon(slurm_log, "slurmctld", "-D", "-f", conf, env=environment), daemon(slurm_log, "slurmd", "-D", "-f", conf, "-N", host, env=environment):
            try:
                wait_for("idle Slurm node", 40, lambda: "idle" in run("sinfo", "-h", "-o", "%T", env=environment).stdout)
                number = checked("sbatch", "--parsable", folder / "slurm.sh", env=environment).strip()

                def queued():
                    return run("squeue", "-h", "-j", number, env=environment).stdout.strip() != ""
                killed = kill_some(folder, queued)
                wait_for("end of the array", 120, lambda: not queued())
            except AssertionError as error:
                raise AssertionError(f"{error}\n{slurm_log.read_text(errors='replace')[-3000:]}") from error
    check_result(folder, expected, killed, "Slurm job array")


def main():
    installed = run(ROOT / "tools/setup", "sweep")
    if installed.returncode != 0:
        print(f"skipped: GNU parallel, ssh, Slurm or munge cannot be installed: {installed.stderr.strip()}")
        return 0
    with tempfile.TemporaryDirectory(dir="/tmp") as name:
        place = pathlib.Path(name)
        place.chmod(0o755)
        spec = place / "spec.json"
        spec.write_text(json.dumps(SPEC))
        checked(BINARY, "sweep", spec, "--out", place / "one.csv")
        expected = (place / "one.csv").read_bytes()
        over_ssh(place, spec, expected)
        with_slurm(place, spec, expected)
    return 0


if __name__ == "__main__":
    sys.exit(main())
