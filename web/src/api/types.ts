// Short names of the API's types, which are generated from api/openapi.json.
import type { components } from "./schema";

type Schemas = components["schemas"];

export type Session = Schemas["Session"];
export type Project = Schemas["Project"];
export type Video = Schemas["Video"];
export type LeftOutTime = Schemas["LeftOutTime"];
export type FoundObject = Schemas["Object"];
export type Moment = Schemas["Moment"];
export type RegroupedObjects = Schemas["RegroupedObjects"];
export type ObjectDetail = Schemas["ObjectDetail"];
export type ObjectEvidence = Schemas["ObjectEvidence"];
export type Evidence = Schemas["Evidence"];
export type Sighting = Schemas["Sighting"];
export type Job = Schemas["Job"];
export type Cluster = Schemas["Cluster"];
export type ClusterSource = Schemas["ClusterSource"];
export type ClusterTask = Schemas["ClusterTask"];
export type NewJob = Schemas["NewJob"];
export type Counts = Schemas["ObjectCounts"];
export type ModelViews = Schemas["ModelViews"];
export type ThresholdList = Schemas["ThresholdList"];
export type ThresholdOfModel = Schemas["ThresholdOfModel"];
export type Coverage = Schemas["Coverage"];
export type CameraPath = Schemas["CameraPath"];
export type CameraPoint = Schemas["CameraPoint"];
export type Place = Schemas["Place"];
export type Review = Schemas["Review"];
export type ReviewedObject = Schemas["ReviewedObject"];
export type Verdict = Review["verdict"];
export type ApiErrorBody = Schemas["Error"];
