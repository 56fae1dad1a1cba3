-- How far jobs come. docs/formats/index.md describes every table and column.

-- The furthest that any attempt has come: who comes further is not what kills its workers.
ALTER TABLE jobs ADD COLUMN furthest INTEGER NOT NULL DEFAULT 0;
-- How far the search of a live source is behind it.
ALTER TABLE jobs ADD COLUMN behind_s REAL;
