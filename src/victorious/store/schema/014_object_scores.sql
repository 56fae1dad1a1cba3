-- A score of each object over all its sightings. docs/formats/index.md describes every table and column.

-- By data association; NULL: of a category, or not computed yet. `score` is then the maximum over its tracklets.
ALTER TABLE objects ADD COLUMN object_score REAL;
-- What speaks against it, one reason a line; NULL: nothing.
ALTER TABLE objects ADD COLUMN against TEXT;
-- The numbers behind object_score, a JSON object.
ALTER TABLE objects ADD COLUMN evidence TEXT;

DROP TRIGGER tracklet_changed;
DROP TRIGGER tracklet_added;
DROP TRIGGER tracklet_deleted;
CREATE TRIGGER tracklet_changed AFTER UPDATE OF object_id, score, frames, first_time_s, last_time_s ON tracklets
WHEN OLD.object_id IS NOT NEW.object_id OR OLD.score <> NEW.score OR OLD.frames <> NEW.frames OR
     OLD.first_time_s <> NEW.first_time_s OR OLD.last_time_s <> NEW.last_time_s
BEGIN
  UPDATE objects SET (score, frames, first_time_s, last_time_s) =
    (SELECT iif(count(*) = 0, NULL, coalesce(objects.object_score, max(t.score))), sum(t.frames), min(t.first_time_s),
            max(t.last_time_s)
     FROM tracklets t WHERE t.object_id = objects.id)
  WHERE id IN (OLD.object_id, NEW.object_id);
END;
CREATE TRIGGER tracklet_added AFTER INSERT ON tracklets WHEN NEW.object_id IS NOT NULL
BEGIN
  UPDATE objects SET (score, frames, first_time_s, last_time_s) =
    (SELECT iif(count(*) = 0, NULL, coalesce(objects.object_score, max(t.score))), sum(t.frames), min(t.first_time_s),
            max(t.last_time_s)
     FROM tracklets t WHERE t.object_id = objects.id)
  WHERE id = NEW.object_id;
END;
CREATE TRIGGER tracklet_deleted AFTER DELETE ON tracklets WHEN OLD.object_id IS NOT NULL
BEGIN
  UPDATE objects SET (score, frames, first_time_s, last_time_s) =
    (SELECT iif(count(*) = 0, NULL, coalesce(objects.object_score, max(t.score))), sum(t.frames), min(t.first_time_s),
            max(t.last_time_s)
     FROM tracklets t WHERE t.object_id = objects.id)
  WHERE id = OLD.object_id;
END;
CREATE TRIGGER object_scored AFTER UPDATE OF object_score ON objects WHEN OLD.object_score IS NOT NEW.object_score
BEGIN
  UPDATE objects SET score =
    (SELECT iif(count(*) = 0, NULL, coalesce(NEW.object_score, max(t.score))) FROM tracklets t
     WHERE t.object_id = objects.id)
  WHERE id = NEW.id;
END;
