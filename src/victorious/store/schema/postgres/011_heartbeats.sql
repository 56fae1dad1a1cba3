-- When the worker of a task said last that it is alive, so that a person sees how long it has been silent.

ALTER TABLE tasks ADD COLUMN renewed_at timestamptz;
