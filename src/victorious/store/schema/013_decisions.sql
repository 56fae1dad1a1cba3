-- A decision for each person. docs/formats/index.md describes every table and column.

-- The key of a review has its reviewer: at one place each person has an own one.
CREATE TABLE reviews_of_persons (
  video_content_id TEXT NOT NULL,
  model_name       TEXT NOT NULL,
  frame            INTEGER NOT NULL,
  box_x_px         REAL NOT NULL,
  box_y_px         REAL NOT NULL,
  box_width_px     REAL NOT NULL,
  box_height_px    REAL NOT NULL,
  reviewer         TEXT NOT NULL,
  verdict          TEXT,
  note             TEXT NOT NULL,
  updated_utc_us   INTEGER NOT NULL,
  PRIMARY KEY (video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px, box_height_px, reviewer)
) STRICT, WITHOUT ROWID;
INSERT INTO reviews_of_persons SELECT video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px,
  box_height_px, reviewer, verdict, note, updated_utc_us FROM reviews;
DROP TABLE reviews;
ALTER TABLE reviews_of_persons RENAME TO reviews;

-- The latest review of each person that belongs to an object.
CREATE TABLE decisions (
  object_id        INTEGER NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  reviewer         TEXT NOT NULL,
  verdict          TEXT,
  note             TEXT NOT NULL,
  decided_utc_us   INTEGER NOT NULL,
  PRIMARY KEY (object_id, reviewer)
) STRICT, WITHOUT ROWID;
CREATE INDEX decisions_by_reviewer ON decisions (reviewer, object_id, verdict);
INSERT INTO decisions
SELECT t.object_id, r.reviewer, r.verdict, r.note, max(r.updated_utc_us)
FROM reviews r CROSS JOIN videos v ON v.content_id = r.video_content_id
CROSS JOIN models m ON m.name = r.model_name
CROSS JOIN sightings s ON s.video_id = v.id AND s.frame = r.frame
CROSS JOIN tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id
WHERE t.object_id IS NOT NULL AND
      3 * max(0, min(r.box_x_px + r.box_width_px, s.box_x_px + s.box_width_px) - max(r.box_x_px, s.box_x_px)) *
          max(0, min(r.box_y_px + r.box_height_px, s.box_y_px + s.box_height_px) - max(r.box_y_px, s.box_y_px))
      >= r.box_width_px * r.box_height_px + s.box_width_px * s.box_height_px
GROUP BY t.object_id, r.reviewer;

-- Persons disagree about its verdict.
ALTER TABLE objects ADD COLUMN is_contested INTEGER NOT NULL DEFAULT 0;
-- The review of the team: the latest with a verdict, else the latest.
UPDATE objects SET (verdict, note, reviewer, reviewed_utc_us) =
    (SELECT d.verdict, d.note, d.reviewer, d.decided_utc_us FROM decisions d WHERE d.object_id = objects.id
     ORDER BY d.verdict IS NULL, d.decided_utc_us DESC, d.reviewer LIMIT 1),
  is_contested = (SELECT count(DISTINCT d.verdict) > 1 FROM decisions d WHERE d.object_id = objects.id)
WHERE id IN (SELECT object_id FROM decisions);
CREATE INDEX objects_contested ON objects (id) WHERE is_contested = 1;
