// A picture of the map for paper: with north and a scale.
import { gridSpacing } from "./geo";
import { formatMetres } from "./format";

export interface ScaleBar {
  /** Of the picture. */
  px: number;
  label: string;
}

/** A bar of 1, 2 or 5 times a power of ten metres, a fifth to a half of the width long. */
export function scaleBar(widthPx: number, widthMetres: number): ScaleBar {
  const metres = gridSpacing(widthMetres, 5);
  return { px: (widthPx * metres) / widthMetres, label: formatMetres(metres).replace(/\.0 (k?m)$/, " $1") };
}

/**
 * Draws north and scale into the lower left corner.
 * @param bearing  of what is up, degrees clockwise from north
 * @param unit  of lengths, px of the picture: 1 for a screen of 96 dpi
 */
export function drawNorthAndScale(context: CanvasRenderingContext2D, bar: ScaleBar, bearing: number, unit: number) {
  const { height } = context.canvas;
  context.save();
  context.scale(unit, unit);
  const bottom = height / unit - 12;
  context.font = "600 13px sans-serif";
  const width = bar.px / unit;
  context.fillStyle = "rgb(255 255 255 / 88%)";
  context.fillRect(8, bottom - 34, Math.max(width, context.measureText(bar.label).width) + 56, 42);
  context.fillStyle = context.strokeStyle = "#000";
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(52, bottom - 8);
  context.lineTo(52, bottom);
  context.lineTo(52 + width, bottom);
  context.lineTo(52 + width, bottom - 8);
  context.stroke();
  context.fillText(bar.label, 52, bottom - 13);
  context.translate(28, bottom - 13);
  context.rotate((-bearing * Math.PI) / 180);
  context.beginPath();
  context.moveTo(0, -18);
  context.lineTo(7, 2);
  context.lineTo(0, -3);
  context.lineTo(-7, 2);
  context.closePath();
  context.fill();
  context.fillText("N", -5, 15);
  context.restore();
}
