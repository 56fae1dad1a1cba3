-- The folder of a relative name. docs/formats/index.md describes every table and column.
ALTER TABLE videos ADD COLUMN folder TEXT NOT NULL DEFAULT '';
