"use strict";
(() => {
  const data = document.getElementById("run");
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((part) => { part.open = true; }));
  if (!data) return;

  // -- the run: frames of integers; x, y in `unit` metres from the leader --------------------------------------------
  const run = JSON.parse(data.textContent);
  const count = run.names.length, frames = run.t.length, end = run.t[frames - 1], begin = run.t[0];
  const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "", "#8c6d31", "#7f7f7f", "#7d5bb5"];
  const find = (id) => document.getElementById(id);
  const player = find("player"), stage = find("stage"), scrub = find("scrub"), clock = find("clock"), play = find("play");
  const pen = stage.getContext("2d");
  const speeds = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
  let now = begin, playing = false, last = 0, ink = "", soft = "", printing = false;

  // The frame at or before a time.
  const frameAt = (t) => {
    let low = 0, high = frames - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (run.t[middle] <= t) low = middle; else high = middle - 1;
    }
    return low;
  };

  const poses = (t) => {
    const k = frameAt(t), next = Math.min(k + 1, frames - 1);
    const part = next > k ? (t - run.t[k]) / (run.t[next] - run.t[k]) : 0;
    const between = (list, i) => list[k * count + i] * (1 - part) + list[next * count + i] * part;
    return run.names.map((_, i) => ({ x: between(run.x, i), y: between(run.y, i), theta: between(run.theta, i) * run.angle }));
  };

  // -- the picture ------------------------------------------------------------------------------------------------------
  const box = (xs, ys) => {
    let left = Infinity, right = -Infinity, low = Infinity, high = -Infinity;
    for (const x of xs) { left = Math.min(left, x); right = Math.max(right, x); }
    for (const y of ys) { low = Math.min(low, y); high = Math.max(high, y); }
    return { left, right, low, high };
  };
  const goals = [...run.goal, [0, 0]];
  const whole = box([...run.x, ...goals.map((g) => g[0])], [...run.y, ...goals.map((g) => g[1])]);

  const camera = (fleet) => {
    const seen = find("view").value === "all" ? whole
      : box(fleet.map((v) => v.x).concat(goals.map((g) => g[0])), fleet.map((v) => v.y).concat(goals.map((g) => g[1])));
    const width = stage.clientWidth, height = stage.clientHeight, margin = Math.min(60, width / 8);
    const size = Math.min((width - 2 * margin) / Math.max(seen.right - seen.left, 1e-3 / run.unit),
      (height - 2 * margin) / Math.max(seen.high - seen.low, 1e-3 / run.unit));
    const middleX = (seen.left + seen.right) / 2, middleY = (seen.low + seen.high) / 2;
    return { size, x: (x) => width / 2 + (x - middleX) * size, y: (y) => height / 2 - (y - middleY) * size, width, height };
  };

  const line = (from, to) => { pen.beginPath(); pen.moveTo(...from); pen.lineTo(...to); pen.stroke(); };
  const colour = (i) => colours[i % colours.length] || ink;

  const ruler = (view) => {
    const metres = 90 / view.size * run.unit, step = 10 ** Math.floor(Math.log10(metres));
    const nice = [5, 2, 1].map((n) => n * step).find((n) => n <= metres) || step;
    const pixels = nice / run.unit * view.size, y = view.height - 16;
    pen.strokeStyle = pen.fillStyle = soft;
    line([14, y], [14 + pixels, y]); line([14, y - 4], [14, y + 4]); line([14 + pixels, y - 4], [14 + pixels, y + 4]);
    pen.fillText(`${Number(nice.toPrecision(2))} m`, 20 + pixels, y + 4);
  };

  const star = (x, y) => {
    pen.fillStyle = ink;
    pen.beginPath();
    for (let k = 0; k < 10; k += 1) {
      const size = k % 2 ? 3.5 : 8, angle = Math.PI * (k / 5 - 0.5);
      pen.lineTo(x + size * Math.cos(angle), y + size * Math.sin(angle));
    }
    pen.fill();
    line([x, y], [x + 22 * Math.cos(run.heading), y - 22 * Math.sin(run.heading)]);
  };

  const trails = (view, fleet) => {
    const k = frameAt(now);
    pen.globalAlpha = 0.55;
    fleet.forEach((vehicle, i) => {
      pen.strokeStyle = colour(i);
      pen.beginPath();
      for (let frame = 0; frame <= k; frame += 1) pen.lineTo(view.x(run.x[frame * count + i]), view.y(run.y[frame * count + i]));
      pen.lineTo(view.x(vehicle.x), view.y(vehicle.y));
      pen.stroke();
    });
    pen.globalAlpha = 1;
  };

  const links = (view, fleet) => {
    pen.strokeStyle = soft;
    pen.globalAlpha = 0.7;
    const at = (i) => [view.x(fleet[i].x), view.y(fleet[i].y)];
    run.edges.forEach(([i, j]) => line(at(i), at(j)));
    pen.setLineDash([5, 5]);
    run.led.forEach((i) => line(at(i), [view.x(0), view.y(0)]));
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  };

  const vehicles = (view, fleet) => {
    const size = count > 20 ? 6 : 9;
    fleet.forEach((vehicle, i) => {
      const x = view.x(vehicle.x), y = view.y(vehicle.y), angle = vehicle.theta;
      pen.strokeStyle = pen.fillStyle = colour(i);
      pen.beginPath(); pen.arc(view.x(run.goal[i][0]), view.y(run.goal[i][1]), size, 0, 2 * Math.PI); pen.stroke();
      pen.beginPath(); pen.arc(x, y, size * 0.6, 0, 2 * Math.PI); pen.fill();
      if (find("headings").checked) {
        const tip = [x + 2.6 * size * Math.cos(angle), y - 2.6 * size * Math.sin(angle)];
        pen.lineWidth = 2;
        line([x, y], tip);
        for (const turn of [2.6, -2.6]) line(tip, [tip[0] + size * Math.cos(angle + turn), tip[1] - size * Math.sin(angle + turn)]);
        pen.lineWidth = 1;
      }
      if (find("names").checked) pen.fillText(run.names[i].slice(0, 24), x + size, y - size);
    });
  };

  const draw = () => {
    const scale = devicePixelRatio || 1, width = stage.clientWidth, height = stage.clientHeight;
    if (stage.width !== Math.round(width * scale) || stage.height !== Math.round(height * scale)) {
      stage.width = Math.round(width * scale); stage.height = Math.round(height * scale);
    }
    const style = getComputedStyle(document.documentElement);
    ink = printing ? "#000" : style.getPropertyValue("--ink"); soft = printing ? "#444" : style.getPropertyValue("--soft");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    pen.lineWidth = 1;
    const fleet = poses(now), view = camera(fleet);
    if (find("trails").checked) trails(view, fleet);
    if (find("links").checked) links(view, fleet);
    pen.strokeStyle = ink;
    star(view.x(0), view.y(0));
    vehicles(view, fleet);
    ruler(view);
    bars();
    clock.textContent = `${now.toFixed(1)} s of ${end.toFixed(0)} s`;
    scrub.value = now;
    scrub.setAttribute("aria-valuetext", `${now.toFixed(1)} seconds`);
  };

  // -- torque bars ------------------------------------------------------------------------------------------------------
  const rows = run.names.map((name, i) => {
    const row = document.createElement("div"), label = document.createElement("span"), wheels = document.createElement("span");
    const left = document.createElement("i"), right = document.createElement("i"), value = document.createElement("span");
    row.className = "torque"; label.className = "name"; wheels.className = "wheels"; value.className = "value";
    label.textContent = label.title = name;
    left.title = "left wheel"; right.title = "right wheel";
    wheels.style.color = colours[i % colours.length] || "var(--ink)";
    wheels.append(left, right); row.append(label, wheels, value); find("torques").append(row);
    return { left, right, value };
  });
  const peak = [...run.left, ...run.right].reduce((a, b) => Math.max(a, b), 0) * run.ratio;
  find("logarithmic").checked = peak < 0.1;
  find("names").checked = count <= 20;

  const length = (share) => find("logarithmic").checked
    ? 100 * Math.min(1, Math.max(0, 1 + Math.log10(Math.max(share, 1e-9)) / 4)) : 100 * Math.min(1, share);

  const bars = () => {
    const k = frameAt(now);
    rows.forEach((row, i) => {
      const left = run.left[k * count + i] * run.ratio, right = run.right[k * count + i] * run.ratio;
      row.left.style.width = `${length(left)}%`; row.right.style.width = `${length(right)}%`;
      row.value.textContent = `${(100 * Math.max(left, right)).toFixed(2)} %`;
    });
    find("scale").textContent = find("logarithmic").checked
      ? "Upper bar left wheel, lower bar right wheel; logarithmic from 0.01 % to the limit, the line at the end."
      : "Upper bar left wheel, lower bar right wheel; linear from 0 to the limit, the line at the end.";
  };

  // -- the player -------------------------------------------------------------------------------------------------------
  const seek = (t) => { now = Math.min(end, Math.max(begin, t)); draw(); };
  const tick = (time) => {
    if (!playing) return;
    const elapsed = Math.min(0.1, (time - last) / 1000);
    last = time;
    seek(now + elapsed * Number(find("speed").value));
    if (now >= end) toggle(false); else requestAnimationFrame(tick);
  };
  const toggle = (on) => {
    playing = on;
    play.textContent = on ? "Pause" : "Play";
    if (!on) return;
    if (now >= end) now = begin;
    last = performance.now();
    requestAnimationFrame(tick);
  };

  speeds.forEach((speed) => find("speed").add(new Option(`${speed} ×`, speed)));
  find("speed").value = speeds.reduce((a, b) => (Math.abs(Math.log(b * 40 / (end - begin || 1))) < Math.abs(Math.log(a * 40 / (end - begin || 1))) ? b : a));
  const faster = (step) => {
    const list = find("speed");
    list.selectedIndex = Math.min(speeds.length - 1, Math.max(0, list.selectedIndex + step));
  };
  const keys = {
    " ": () => toggle(!playing), ArrowRight: () => seek(now + (end - begin) / 100), ArrowLeft: () => seek(now - (end - begin) / 100),
    Home: () => seek(begin), End: () => seek(end), "+": () => faster(1), "=": () => faster(1), "-": () => faster(-1),
  };

  scrub.min = begin; scrub.max = end;
  play.addEventListener("click", () => toggle(!playing));
  scrub.addEventListener("input", () => seek(Number(scrub.value)));
  player.addEventListener("keydown", (event) => {
    // A control keeps the keys that it has itself.
    if (event.target !== player || event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  });
  for (const id of ["view", "trails", "links", "headings", "names", "logarithmic"]) find(id).addEventListener("change", draw);
  addEventListener("resize", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  addEventListener("beforeprint", () => { printing = true; toggle(false); draw(); });
  addEventListener("afterprint", () => { printing = false; draw(); });
  new ResizeObserver(draw).observe(stage);
  draw();
})();
