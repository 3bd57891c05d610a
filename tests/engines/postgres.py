"""A PostgreSQL of its own in a folder, on a socket there, as the user `postgres` where this runs as root.

    python postgres.py FOLDER COMMAND...

Runs a command while it is up: `psql` and `createdb` find it by their environment.
"""

import glob
import os
import shutil
import subprocess
import sys

BIN = max(glob.glob("/usr/lib/postgresql/*/bin"), default="", key=lambda path: int(path.split("/")[4]))


class Postgres:
    def __init__(self, work):
        self.data, self.work = f"{work}/data", work
        self.stop()
        shutil.rmtree(work, ignore_errors=True)
        os.makedirs(work)
        if os.geteuid() == 0:
            shutil.chown(work, "postgres")
        self.run(f"{BIN}/initdb", "-D", self.data, "-A", "trust", "-E", "UTF8", "--no-sync")
        options = f"-c listen_addresses='' -k {work} -c fsync=off"
        self.run(f"{BIN}/pg_ctl", "-D", self.data, "-w", "-l", f"{work}/log", "-o", options, "start")

    def run(self, *command, folder=None):
        user = ["runuser", "-u", "postgres", "--"] if os.geteuid() == 0 else []
        done = subprocess.run([*user, *command], capture_output=True, text=True, cwd=folder or "/tmp")
        if done.returncode:
            sys.exit(f"{command[0]} failed: {done.stdout[-800:]}{done.stderr[-800:]}")
        return done.stdout

    def psql(self, *arguments, folder=None):
        return self.run(f"{BIN}/psql", "-h", self.work, "-d", "postgres", "-qAt", *arguments, folder=folder)

    def stop(self):
        if os.path.exists(f"{self.data}/postmaster.pid"):
            self.run(f"{BIN}/pg_ctl", "-D", self.data, "-m", "immediate", "stop")


def main(folder, *command):
    postgres = Postgres(folder)
    try:
        user = {"PGUSER": "postgres"} if os.geteuid() == 0 else {}
        return subprocess.run(command, env={**os.environ, "PGHOST": folder, **user}).returncode
    finally:
        postgres.stop()


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
