#!/usr/bin/env bash
# scratch_postgres.sh [--restart] [NAME=VALUE]...: a PostgreSQL server for tests, as Debian ships it, in a temporary
# folder: no network, no syncing. NAME=VALUE are settings of the server, before those of tests (fsync=on).
# Prints the URL of an empty database with PostGIS, then serves until its standard input ends, which is when the process
# that started it ends; then removes everything. Called by root, the server runs as user postgres.
# With --restart, a server that was killed is started again on the same data; its process is the first line of
# data/postmaster.pid, in the folder of its socket.
# Exit status 77 if PostgreSQL 15 or PostGIS is not installed, with the reason on standard output.
set -euo pipefail

restarts=false
if [[ "${1:-}" == --restart ]]; then
  restarts=true
  shift
fi
settings=()
for setting in "$@"; do
  if [[ "$setting" != *=* ]]; then
    echo "scratch_postgres.sh: $setting: give a setting of the server, NAME=VALUE" >&2
    exit 2
  fi
  settings+=(-c "$setting")
done

bin="$(ls -d /usr/lib/postgresql/*/bin 2>/dev/null | sort -V | tail -1 || true)"
if [[ -z "$bin" || ! -x "$bin/initdb" ]]; then
  echo "no PostgreSQL server: install postgresql-15 (tools/install_packages.sh --test)"
  exit 77
fi
version="$(basename "$(dirname "$bin")")"
if [[ ! -e "/usr/share/postgresql/$version/extension/postgis.control" ]]; then
  echo "no PostGIS: install postgresql-15-postgis-3 (tools/install_packages.sh --test)"
  exit 77
fi

folder="$(mktemp -d /tmp/victorious-postgres-XXXXXX)"
as_server=()
if [[ "$(id -u)" == "0" ]]; then
  as_server=(setpriv --reuid postgres --regid postgres --clear-groups --)
  chown postgres "$folder"
fi
server=""
input=""
cleanup() {
  if [[ -n "$server" ]]; then
    kill -QUIT "$server" 2>/dev/null || true  # at once: nothing is kept
    wait "$server" 2>/dev/null || true
  fi
  if [[ -n "$input" ]]; then kill "$input" 2>/dev/null || true; fi
  rm -rf "$folder"
}
trap cleanup EXIT
trap 'exit 1' HUP INT TERM
cd "$folder"

start_server() {
  "${as_server[@]}" "$bin/postgres" -D "$folder/data" -k "$folder" -c listen_addresses= -c fsync=off \
    -c synchronous_commit=off -c full_page_writes=off -c wal_level=minimal -c max_wal_senders=0 \
    -c shared_buffers=32MB -c autovacuum=off -c max_connections=40 "${settings[@]}" </dev/null >>"$folder/server.log" 2>&1 &
  server=$!
}

# The role with_password has to give one; all others are trusted, but only their user reaches the socket.
export LC_ALL=C
"${as_server[@]}" "$bin/initdb" --pgdata="$folder/data" --username=victorious --auth=trust --encoding=UTF8 \
  --locale=C.UTF-8 --no-sync --no-instructions >"$folder/initdb.log" 2>&1 || { cat "$folder/initdb.log" >&2; exit 1; }
printf 'local all with_password scram-sha-256\nlocal all all trust\n' >"$folder/data/pg_hba.conf"
start_server
for ((i = 0; ; ++i)); do
  "$bin/pg_isready" --quiet --host="$folder" && break
  if ((i >= 600)) || ! kill -0 "$server" 2>/dev/null; then
    cat "$folder/server.log" >&2
    exit 1
  fi
  sleep 0.1
done
psql=("$bin/psql" --quiet --no-psqlrc --host="$folder" --username=victorious --set=ON_ERROR_STOP=1)
"${psql[@]}" --dbname=postgres --command="CREATE DATABASE index" >&2
"${psql[@]}" --dbname=index --command="CREATE EXTENSION postgis" >&2
echo "postgresql://victorious@/index?host=$folder"
if ! $restarts; then
  cat >/dev/null
  exit 0
fi
exec >/dev/null 2>>"$folder/server.log"
cat <&0 &
input=$!
while true; do
  wait -n "$server" "$input" || true
  kill -0 "$input" 2>/dev/null || exit 0
  sleep 0.1  # processes of the killed server may still hold its memory: a start is refused meanwhile
  start_server
done
