-- What `victorious serve` needs: what lists and maps of objects ask for, kept with each object, as in a file; accounts,
-- jobs, thresholds and the log of who did what. docs/formats/index.md describes every table and column.

-- Of its tracklets, kept by the triggers below; NULL: it has none.
ALTER TABLE objects ADD COLUMN score double precision, ADD COLUMN frames bigint,
  ADD COLUMN first_time_s double precision, ADD COLUMN last_time_s double precision;
-- The review of the team: the latest with a verdict, else the latest; NULL: there is none.
ALTER TABLE objects ADD COLUMN verdict text, ADD COLUMN note text, ADD COLUMN reviewer text,
  ADD COLUMN reviewed_utc_us bigint;
-- Persons disagree about its verdict.
ALTER TABLE objects ADD COLUMN is_contested bigint NOT NULL DEFAULT 0;

-- The latest review of each person that belongs to an object.
CREATE TABLE decisions (
  object_id      bigint NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  reviewer       text NOT NULL,
  verdict        text,
  note           text NOT NULL,
  decided_utc_us bigint NOT NULL,
  PRIMARY KEY (object_id, reviewer)
);
CREATE INDEX decisions_by_reviewer ON decisions (reviewer, object_id) WHERE verdict IS NOT NULL;

UPDATE objects o SET score = coalesce(o.object_score, s.score), frames = s.frames, first_time_s = s.first_time_s,
  last_time_s = s.last_time_s
FROM (SELECT object_id, max(score) AS score, CAST(sum(frames) AS bigint) AS frames, min(first_time_s) AS first_time_s,
        max(last_time_s) AS last_time_s
      FROM tracklets GROUP BY object_id) s
WHERE s.object_id = o.id;
INSERT INTO decisions (object_id, reviewer, verdict, note, decided_utc_us)
SELECT DISTINCT ON (t.object_id, r.reviewer) t.object_id, r.reviewer, r.verdict, r.note, r.updated_utc_us
FROM reviews r JOIN videos v ON v.content_id = r.video_content_id JOIN models m ON m.name = r.model_name
JOIN sightings s ON s.video_id = v.id AND s.frame = r.frame
JOIN tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id AND t.object_id IS NOT NULL AND
  3 * greatest(0, least(r.box_x_px + r.box_width_px, s.box_x_px + s.box_width_px) - greatest(r.box_x_px, s.box_x_px)) *
      greatest(0, least(r.box_y_px + r.box_height_px, s.box_y_px + s.box_height_px) - greatest(r.box_y_px, s.box_y_px))
  >= r.box_width_px * r.box_height_px + s.box_width_px * s.box_height_px
ORDER BY t.object_id, r.reviewer, r.updated_utc_us DESC;
UPDATE objects o SET (verdict, note, reviewer, reviewed_utc_us) =
    (SELECT d.verdict, d.note, d.reviewer, d.decided_utc_us FROM decisions d WHERE d.object_id = o.id
     ORDER BY d.verdict IS NULL, d.decided_utc_us DESC, d.reviewer LIMIT 1),
  is_contested = (SELECT CASE WHEN count(DISTINCT d.verdict) > 1 THEN 1 ELSE 0 END FROM decisions d
                  WHERE d.object_id = o.id)
WHERE o.id IN (SELECT object_id FROM decisions);

-- Best first is ascending by the first two and id: one direction, so that a row value selects what follows an object.
ALTER TABLE objects
  ADD COLUMN order_score double precision GENERATED ALWAYS AS (-score) STORED,
  ADD COLUMN order_frames bigint GENERATED ALWAYS AS (-frames) STORED,
  ADD COLUMN is_listed bigint GENERATED ALWAYS AS (
    CASE WHEN coalesce(frames, 0) > 0 AND (coalesce(rejection_reason, '') = '' OR rejection_reason LIKE 'place: %')
    THEN 1 ELSE 0 END) STORED;

CREATE INDEX objects_by_rank ON objects (order_score, order_frames, id)
  INCLUDE (model_id, verdict, reviewed_utc_us) WHERE is_listed = 1;
CREATE INDEX objects_decided ON objects (order_score, order_frames, id) INCLUDE (model_id, verdict)
  WHERE is_listed = 1 AND verdict IS NOT NULL;
CREATE INDEX objects_by_latitude ON objects (latitude_rad, longitude_rad)
  INCLUDE (id, model_id, order_score, verdict) WHERE latitude_rad IS NOT NULL AND is_listed = 1;
CREATE INDEX objects_with_note ON objects (id) WHERE note <> '';
CREATE INDEX objects_contested ON objects (id) WHERE is_contested = 1;
CREATE INDEX tracklets_by_video ON tracklets (video_id, object_id) INCLUDE (first_time_s, last_time_s);
-- The best sighting of a tracklet is the last entry of its part.
DROP INDEX sightings_by_tracklet;
CREATE INDEX sightings_by_tracklet ON sightings (tracklet_id, matches, score);

-- Whoever writes tracklets holds the rows of their objects (sql_index_store.cc: LockObjectsOf), or all of them.
CREATE FUNCTION summarise_objects(ids bigint[]) RETURNS void LANGUAGE sql AS $$
  UPDATE victorious.objects o
  SET score = s.score, frames = s.frames, first_time_s = s.first_time_s, last_time_s = s.last_time_s
  FROM (SELECT p.id, CASE WHEN count(t.id) > 0 THEN coalesce(p.object_score, max(t.score)) END AS score,
          CAST(sum(t.frames) AS bigint) AS frames, min(t.first_time_s) AS first_time_s,
          max(t.last_time_s) AS last_time_s
        FROM victorious.objects p LEFT JOIN victorious.tracklets t ON t.object_id = p.id
        WHERE p.id = ANY (ids) GROUP BY p.id, p.object_score) s
  WHERE o.id = s.id AND (o.score, o.frames, o.first_time_s, o.last_time_s) IS DISTINCT FROM
    (s.score, s.frames, s.first_time_s, s.last_time_s)
$$;
CREATE FUNCTION tracklets_added() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  PERFORM victorious.summarise_objects(ARRAY(SELECT DISTINCT object_id FROM added WHERE object_id IS NOT NULL));
  RETURN NULL;
END $$;
CREATE FUNCTION tracklets_changed() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  PERFORM victorious.summarise_objects(ARRAY(
    SELECT DISTINCT c.object_id FROM former f JOIN present p USING (id)
    CROSS JOIN LATERAL (VALUES (f.object_id), (p.object_id)) AS c (object_id)
    WHERE c.object_id IS NOT NULL AND (f.object_id, f.score, f.frames, f.first_time_s, f.last_time_s) IS DISTINCT FROM
      (p.object_id, p.score, p.frames, p.first_time_s, p.last_time_s)));
  RETURN NULL;
END $$;
CREATE FUNCTION tracklets_deleted() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  PERFORM victorious.summarise_objects(ARRAY(SELECT DISTINCT object_id FROM deleted WHERE object_id IS NOT NULL));
  RETURN NULL;
END $$;
CREATE FUNCTION object_scored() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  NEW.score := (SELECT CASE WHEN count(*) > 0 THEN coalesce(NEW.object_score, max(t.score)) END
                FROM victorious.tracklets t WHERE t.object_id = NEW.id);
  RETURN NEW;
END $$;
CREATE TRIGGER tracklets_added AFTER INSERT ON tracklets REFERENCING NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION tracklets_added();
CREATE TRIGGER tracklets_changed AFTER UPDATE ON tracklets REFERENCING OLD TABLE AS former NEW TABLE AS present
  FOR EACH STATEMENT EXECUTE FUNCTION tracklets_changed();
CREATE TRIGGER tracklets_deleted AFTER DELETE ON tracklets REFERENCING OLD TABLE AS deleted
  FOR EACH STATEMENT EXECUTE FUNCTION tracklets_deleted();
CREATE TRIGGER object_scored BEFORE UPDATE OF object_score ON objects FOR EACH ROW
  WHEN (OLD.object_score IS DISTINCT FROM NEW.object_score) EXECUTE FUNCTION object_scored();

CREATE TABLE thresholds (
  model_name text PRIMARY KEY,
  min_score  double precision NOT NULL,
  set_by     text NOT NULL,
  set_utc_us bigint NOT NULL
);

CREATE TABLE jobs (
  id             bigint GENERATED BY DEFAULT AS IDENTITY PRIMARY KEY,
  kind           text NOT NULL,
  input          text NOT NULL,
  state          text NOT NULL,
  created_utc_us bigint NOT NULL,
  started_utc_us bigint,
  ended_utc_us   bigint,
  owner          text,
  lease_utc_us   bigint,
  attempts       bigint NOT NULL DEFAULT 0,
  cancel_asked   bigint NOT NULL DEFAULT 0,
  done           bigint NOT NULL DEFAULT 0,
  total          bigint,
  unit           text NOT NULL DEFAULT '',
  message        text NOT NULL DEFAULT ''
);
CREATE INDEX jobs_open ON jobs (id) WHERE state IN ('queued', 'running');

CREATE TABLE accounts (
  id             bigint GENERATED BY DEFAULT AS IDENTITY PRIMARY KEY,
  name           text NOT NULL,
  role           text NOT NULL,
  password_hash  text NOT NULL,
  created_utc_us bigint NOT NULL
);
-- Two names that people take for one are one.
CREATE UNIQUE INDEX accounts_by_name ON accounts (lower(name COLLATE "C"));

CREATE TABLE credentials (
  id             bigint GENERATED BY DEFAULT AS IDENTITY PRIMARY KEY,
  account_id     bigint NOT NULL REFERENCES accounts (id) ON DELETE CASCADE,
  kind           text NOT NULL,
  digest         text NOT NULL UNIQUE,
  label          text NOT NULL,
  created_utc_us bigint NOT NULL,
  expires_utc_us bigint NOT NULL
);
CREATE INDEX credentials_by_account ON credentials (account_id);

CREATE TABLE audit (
  id          bigint GENERATED BY DEFAULT AS IDENTITY PRIMARY KEY,
  time_utc_us bigint NOT NULL,
  actor       text NOT NULL,
  action      text NOT NULL,
  subject     text NOT NULL,
  detail      text NOT NULL
);
