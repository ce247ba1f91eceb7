"use strict";
// Draws the charts, and shows the frame that was chosen: by the slider, its arrow keys, a bar of a chart, or a link #frame-5.

const data = JSON.parse(document.getElementById("data").textContent);
const slider = document.getElementById("choose");
const series = [];
let gantt = null;

function nearest(frame) {
  let found = 0;
  data.frames.forEach((each, place) => {
    if (Math.abs(each - frame) < Math.abs(data.frames[found] - frame)) found = place;
  });
  return found;
}

function choose(place) {
  const frame = data.frames[place];
  for (const each of document.querySelectorAll("article.frame")) each.hidden = each.id !== `frame-${frame}`;
  slider.value = place;
  slider.setAttribute("aria-valuetext", `frame ${frame}`);
  document.getElementById("before").disabled = place === 0;
  document.getElementById("after").disabled = place === data.frames.length - 1;
  for (const each of document.querySelectorAll(".chosen")) each.textContent = `frame ${frame}`;
  for (const view of series) view.signal("chosen", frame).runAsync();
  if (gantt) gantt.data("bars", bars(frame)).runAsync();
}

function bars(frame) {
  const chart = data.gantts[frame];
  return !chart ? [] : chart.bars.map(([track, key, first, last, quarters]) => ({
    track: chart.tracks[track], means: chart.keys[key][0], name: chart.keys[key][1],
    begin: first * chart.slice_ms, end: (last + 1) * chart.slice_ms, busy: quarters / 4,
  }));
}

function follow() {
  const found = /^#frame-(\d+)$/.exec(location.hash);
  if (!found) return;
  const place = nearest(Number(found[1]));
  choose(place);
  document.getElementById(`frame-${data.frames[place]}`).focus();
}

slider.addEventListener("input", () => choose(Number(slider.value)));
document.getElementById("before").addEventListener("click", () => choose(Number(slider.value) - 1));
document.getElementById("after").addEventListener("click", () => choose(Number(slider.value) + 1));
window.addEventListener("hashchange", follow);
choose(nearest(data.first));

async function draw(id, spec) {
  const frame = data.frames[Number(slider.value)];
  if (id === "gantt") spec.datasets = {bars: bars(frame)};
  const {view} = await vegaEmbed(`#${CSS.escape(id)}`, spec, {actions: false, renderer: "svg"});
  if (id === "gantt") gantt = view;
  if (!id.startsWith("series-")) return;
  series.push(view);
  view.signal("chosen", frame).runAsync();
  view.addEventListener("click", (_event, item) => {
    if (item && item.datum && "frame" in item.datum) choose(nearest(item.datum.frame));
  });
}

Promise.all(Object.entries(data.charts).map(([id, spec]) => draw(id, spec))).then(() => {
  document.documentElement.dataset.drawn = "yes";
  follow();
});
