-- Thresholds of models that are in force. docs/formats/index.md describes every table and column.

CREATE TABLE thresholds (
  model_name  TEXT PRIMARY KEY,
  min_score   REAL NOT NULL,
  set_by      TEXT NOT NULL,
  set_utc_us  INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
