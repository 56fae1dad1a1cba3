-- What lists and maps of objects ask for, kept with each object, so that a page of a list and a tile of a map are read
-- by an index. docs/formats/index.md describes every table and column.

-- Who reviewed; '' if nobody gave a name.
ALTER TABLE reviews ADD COLUMN reviewer TEXT NOT NULL DEFAULT '';

-- Of its tracklets, kept by the triggers below; NULL: it has none.
ALTER TABLE objects ADD COLUMN score REAL;
ALTER TABLE objects ADD COLUMN frames INTEGER;
ALTER TABLE objects ADD COLUMN first_time_s REAL;
ALTER TABLE objects ADD COLUMN last_time_s REAL;
-- Of the latest review that belongs to it; NULL: there is none.
ALTER TABLE objects ADD COLUMN verdict TEXT;
ALTER TABLE objects ADD COLUMN note TEXT;
ALTER TABLE objects ADD COLUMN reviewer TEXT;
ALTER TABLE objects ADD COLUMN reviewed_utc_us INTEGER;
-- Best first is ascending by these two and id: one direction, so that a row value selects what follows an object.
ALTER TABLE objects ADD COLUMN order_score REAL GENERATED ALWAYS AS (-score) VIRTUAL;
ALTER TABLE objects ADD COLUMN order_frames INTEGER GENERATED ALWAYS AS (-frames) VIRTUAL;
ALTER TABLE objects ADD COLUMN is_listed INTEGER GENERATED ALWAYS AS (
  coalesce(frames, 0) > 0 AND (coalesce(rejection_reason, '') = '' OR instr(rejection_reason, 'place: ') = 1)) VIRTUAL;

CREATE TRIGGER tracklet_changed AFTER UPDATE OF object_id, score, frames, first_time_s, last_time_s ON tracklets
WHEN OLD.object_id IS NOT NEW.object_id OR OLD.score <> NEW.score OR OLD.frames <> NEW.frames OR
     OLD.first_time_s <> NEW.first_time_s OR OLD.last_time_s <> NEW.last_time_s
BEGIN
  UPDATE objects SET (score, frames, first_time_s, last_time_s) =
    (SELECT max(score), sum(frames), min(first_time_s), max(last_time_s) FROM tracklets WHERE object_id = objects.id)
  WHERE id IN (OLD.object_id, NEW.object_id);
END;
CREATE TRIGGER tracklet_added AFTER INSERT ON tracklets WHEN NEW.object_id IS NOT NULL
BEGIN
  UPDATE objects SET (score, frames, first_time_s, last_time_s) =
    (SELECT max(score), sum(frames), min(first_time_s), max(last_time_s) FROM tracklets WHERE object_id = objects.id)
  WHERE id = NEW.object_id;
END;
CREATE TRIGGER tracklet_deleted AFTER DELETE ON tracklets WHEN OLD.object_id IS NOT NULL
BEGIN
  UPDATE objects SET (score, frames, first_time_s, last_time_s) =
    (SELECT max(score), sum(frames), min(first_time_s), max(last_time_s) FROM tracklets WHERE object_id = objects.id)
  WHERE id = OLD.object_id;
END;

UPDATE objects SET (score, frames, first_time_s, last_time_s) =
  (SELECT max(score), sum(frames), min(first_time_s), max(last_time_s) FROM tracklets WHERE object_id = objects.id);
UPDATE objects SET (verdict, note, reviewer, reviewed_utc_us) = (r.verdict, r.note, r.reviewer, r.updated)
FROM (SELECT t.object_id, r.verdict, r.note, r.reviewer, max(r.updated_utc_us) AS updated
      FROM reviews r CROSS JOIN videos v ON v.content_id = r.video_content_id
      CROSS JOIN models m ON m.name = r.model_name
      CROSS JOIN sightings s ON s.video_id = v.id AND s.frame = r.frame
      CROSS JOIN tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id
      WHERE 3 * max(0, min(r.box_x_px + r.box_width_px, s.box_x_px + s.box_width_px) - max(r.box_x_px, s.box_x_px)) *
                max(0, min(r.box_y_px + r.box_height_px, s.box_y_px + s.box_height_px) - max(r.box_y_px, s.box_y_px))
            >= r.box_width_px * r.box_height_px + s.box_width_px * s.box_height_px
      GROUP BY t.object_id) AS r
WHERE objects.id = r.object_id;

CREATE INDEX objects_by_rank ON objects (is_listed, order_score, order_frames, id, model_id, verdict, reviewed_utc_us);
CREATE INDEX objects_by_place ON objects (latitude_rad, longitude_rad, is_listed, id, model_id, order_score, verdict)
  WHERE latitude_rad IS NOT NULL;
CREATE INDEX objects_with_note ON objects (id) WHERE note <> '';
DROP INDEX tracklets_by_video;
CREATE INDEX tracklets_by_video ON tracklets (video_id, object_id, first_time_s, last_time_s);
-- The best sighting of a tracklet is the last entry of its part.
DROP INDEX sightings_by_tracklet;
CREATE INDEX sightings_by_tracklet ON sightings (tracklet_id, matches, score);
