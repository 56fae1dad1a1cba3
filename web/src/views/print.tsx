// The sheet that is printed instead of the page: the map, the list, where it comes from and when.
import { DASH, baseName, formatAngle, formatMetres, formatPosition, formatScore, plural } from "../logic/format";
import type { FoundObject } from "../api/types";
import { isChosen } from "../logic/filters";
import { describeDecisions } from "../logic/decisions";
import { me } from "../me";
import { sheet } from "../print";
import * as state from "../state";

const seenText = (object: FoundObject) =>
  state
    .seenOf(object)
    .map((one) => `${one.first_time_s.toFixed(1)} – ${one.last_time_s.toFixed(1)} s in ${baseName(one.video)}`)
    .join("; ");

function PrintedRow({ object }: { object: FoundObject }) {
  const { place } = object;
  return (
    <tr>
      <td>{object.id}</td>
      <td>{object.model}</td>
      <td>{formatScore(object.score)}</td>
      <td>{place ? formatPosition(place.latitude_deg, place.longitude_deg, state.coordinateStyle.value) : DASH}</td>
      <td>{formatMetres(place?.ce90_m)}</td>
      <td>{place ? `${formatMetres(place.altitude_m)} ± ${formatMetres(place.le90_m)}` : DASH}</td>
      <td>{formatAngle(object.heading_deg)}</td>
      <td>{seenText(object)}</td>
      <td>{[describeDecisions(object, me.value), object.review?.note ?? ""].filter((text) => text !== "").join(": ")}</td>
    </tr>
  );
}

export function PrintSheet() {
  const shown = sheet.value;
  const project = state.project.value;
  if (shown === null || project.state !== "ready") return null;
  const { objects, total } = shown;
  const some = objects.length < total ? `the first ${objects.length.toLocaleString("en")} of ${plural(total, "object")}` : plural(total, "object");
  return (
    <section class="print-sheet" aria-label="What is printed">
      <h1>{baseName(project.value.name)}</h1>
      <p>
        {some}
        {isChosen(state.filters.value) ? " that match the filters" : ""}; printed {shown.when.toISOString().slice(0, 16).replace("T", " ")} UTC by VICTORIOUS
      </p>
      {shown.map !== null && <img src={shown.map} alt="Map, with north and scale" />}
      <table>
        <thead>
          <tr>
            <th>Object</th>
            <th>Model</th>
            <th>Score</th>
            <th>Position (WGS 84)</th>
            <th>90 % within</th>
            <th>Above ellipsoid</th>
            <th>Heading</th>
            <th>Seen</th>
            <th>Review</th>
          </tr>
        </thead>
        <tbody>
          {objects.map((one) => (
            <PrintedRow key={one.id} object={one} />
          ))}
        </tbody>
      </table>
    </section>
  );
}
