-- Who may use `victorious serve`, and who decided what. docs/formats/index.md describes every table and column.

CREATE TABLE accounts (
  id               INTEGER PRIMARY KEY AUTOINCREMENT,
  name             TEXT NOT NULL UNIQUE COLLATE NOCASE,
  role             TEXT NOT NULL,
  password_hash    TEXT NOT NULL,
  created_utc_us   INTEGER NOT NULL
) STRICT;

CREATE TABLE credentials (
  id               INTEGER PRIMARY KEY AUTOINCREMENT,
  account_id       INTEGER NOT NULL REFERENCES accounts (id) ON DELETE CASCADE,
  kind             TEXT NOT NULL,
  digest           TEXT NOT NULL UNIQUE,
  label            TEXT NOT NULL,
  created_utc_us   INTEGER NOT NULL,
  expires_utc_us   INTEGER NOT NULL
) STRICT;
CREATE INDEX credentials_by_account ON credentials (account_id);

CREATE TABLE audit (
  id               INTEGER PRIMARY KEY AUTOINCREMENT,
  time_utc_us      INTEGER NOT NULL,
  actor            TEXT NOT NULL,
  action           TEXT NOT NULL,
  subject          TEXT NOT NULL,
  detail           TEXT NOT NULL
) STRICT;
