// The map, the plots and the driving of web_view: one WebSocket and canvases, no other library.
//
// A frame is JSON: {belief: [x, y, yaw, v, w], truth: [x, y, yaw], covariance: [xx, xy, yy],
// drift: [m, rad], nees, goal, poses, boundary, trails, status, driver, stopped}; what has not
// changed is left out; notice is what went wrong.  What a viewer does goes back as [name, value].
(() => {
  'use strict';
  const SEND_MS = 50, TRAIL = 5000, PLOT_S = 60, CLICK_PX = 6, RETRY_MS = 1000;
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const colours = () => dark.matches
    ? {grid: '#2b3340', ink: '#cfd6e0', belief: '#5aa9ff', truth: '#ff9d45', cloud: '#8d99ab'}
    : {grid: '#e3e7ec', ink: '#2b3340', belief: '#1565c0', truth: '#d9640b', cloud: '#8290a3'};
  const state = {trails: [[], []], plots: {}, poses: [], view: {x: 0, y: 0, scale: 300, own: false}};
  let socket = null, setup = {separation: 0.1, radius: 0.02}, drawn = true;
  const byId = (id) => document.getElementById(id);
  const act = (name, value) => {
    if (socket && socket.readyState === 1) socket.send(JSON.stringify([name, value]));
  };

  // ------------------------------------------------------------------ what comes in
  const PLOTS = [['drift', 'drift [mm]', 'truth'], ['nees', 'NEES / 3', 'belief'],
                 ['speed', 'speed [m/s]', 'ink']];

  function take(frame) {
    if (frame.viewer) setup = frame;
    if (frame.fresh) state.trails = [[], []];
    for (const [i, points] of (frame.trails || []).entries()) {
      state.trails[i].push(...points);
      if (state.trails[i].length > TRAIL) state.trails[i].splice(0, TRAIL / 10);
    }
    Object.assign(state, {...frame, trails: state.trails});
    if (frame.belief) {
      const now = performance.now() / 1000;
      note('speed', now, frame.belief[3]);
      if (frame.drift) note('drift', now, 1000 * frame.drift[0]);
      if (frame.nees != null) note('nees', now, frame.nees / 3);
    }
    if (!drawn) return;
    drawn = false;
    requestAnimationFrame(() => { drawn = true; draw(); });
  }

  function note(name, time, value) {
    const points = state.plots[name] = state.plots[name] || [];
    points.push([time, value]);
    while (points.length && points[0][0] < time - PLOT_S) points.shift();
  }

  function connect() {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    socket = new WebSocket(`${scheme}://${location.host}/robot`);
    socket.onmessage = (event) => take(JSON.parse(event.data));
    socket.onclose = () => {
      state.lost = true;
      draw();
      setTimeout(connect, RETRY_MS);
    };
    socket.onopen = () => { state.lost = false; };
  }

  // ------------------------------------------------------------------ map
  function sized(canvas) {
    const ratio = devicePixelRatio || 1, {clientWidth: w, clientHeight: h} = canvas;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
    }
    const pen = canvas.getContext('2d');
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, w, h);
    return [pen, w, h];
  }

  function fit(w, h) {
    const points = [...state.trails[0], ...state.trails[1], ...state.poses];
    for (const pose of [state.belief, state.truth, state.goal]) if (pose) points.push(pose);
    if (!points.length) return;
    const around = 3 * setup.separation;
    let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const [x, y] of points) {
      x0 = Math.min(x0, x); x1 = Math.max(x1, x); y0 = Math.min(y0, y); y1 = Math.max(y1, y);
    }
    const scale = Math.min(w / (x1 - x0 + 2 * around), h / (y1 - y0 + 2 * around));
    Object.assign(state.view, {x: (x0 + x1) / 2, y: (y0 + y1) / 2, scale});
  }

  function draw() {
    const canvas = byId('dd-map');
    if (!canvas || !canvas.clientWidth) return;
    const [pen, w, h] = sized(canvas), view = state.view, c = colours();
    if (!view.own) fit(w, h);
    const X = (x) => w / 2 + (x - view.x) * view.scale, Y = (y) => h / 2 - (y - view.y) * view.scale;
    grid(pen, w, h, X, Y, view, c);
    line(pen, state.trails[0], X, Y, c.belief, 1.5);
    line(pen, state.trails[1], X, Y, c.truth, 1.5);
    if (state.boundary) line(pen, [...state.boundary, state.boundary[0]], X, Y, c.cloud, 1.2);
    pen.fillStyle = c.cloud;
    for (const [x, y] of state.poses) pen.fillRect(X(x) - 1, Y(y) - 1, 2, 2);
    if (state.goal) cross(pen, X(state.goal[0]), Y(state.goal[1]), c.ink);
    if (state.belief && state.covariance) ellipse(pen, state.belief, state.covariance, X, Y, view, c);
    if (state.truth) robot(pen, state.truth, X, Y, view, c.truth);
    if (state.belief) robot(pen, state.belief, X, Y, view, c.belief);
    words(c);
    plots(c);
  }

  function grid(pen, w, h, X, Y, view, c) {
    let step = 10 ** Math.ceil(Math.log10(60 / view.scale));
    if (step * view.scale > 300) step /= 5; else if (step * view.scale > 120) step /= 2;
    pen.strokeStyle = c.grid;
    pen.lineWidth = 1;
    pen.beginPath();
    for (let x = Math.ceil((view.x - w / 2 / view.scale) / step) * step; X(x) < w; x += step) {
      pen.moveTo(X(x), 0); pen.lineTo(X(x), h);
    }
    for (let y = Math.ceil((view.y - h / 2 / view.scale) / step) * step; Y(y) > 0; y += step) {
      pen.moveTo(0, Y(y)); pen.lineTo(w, Y(y));
    }
    pen.stroke();
    const length = step * view.scale;
    pen.strokeStyle = pen.fillStyle = c.ink;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(16, h - 22); pen.lineTo(16, h - 16); pen.lineTo(16 + length, h - 16);
    pen.lineTo(16 + length, h - 22);
    pen.stroke();
    pen.font = '12px sans-serif';
    pen.fillText(step >= 1 ? `${step} m` : `${+(100 * step).toPrecision(3)} cm`, 20, h - 22);
  }

  function line(pen, points, X, Y, colour, width) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    points.forEach(([x, y], i) => i ? pen.lineTo(X(x), Y(y)) : pen.moveTo(X(x), Y(y)));
    pen.stroke();
  }

  function cross(pen, x, y, colour) {
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(x - 7, y - 7); pen.lineTo(x + 7, y + 7);
    pen.moveTo(x - 7, y + 7); pen.lineTo(x + 7, y - 7);
    pen.stroke();
  }

  function ellipse(pen, [x, y], [xx, xy, yy], X, Y, view, c) {  // 95 %: chi-square(2) 5.991
    const mean = (xx + yy) / 2, half = Math.hypot((xx - yy) / 2, xy);
    const axis = (value) => Math.sqrt(5.991 * Math.max(0, value)) * view.scale;
    pen.strokeStyle = c.belief;
    pen.lineWidth = 1;
    pen.setLineDash([4, 3]);
    pen.beginPath();
    pen.ellipse(X(x), Y(y), axis(mean + half), axis(mean - half), -Math.atan2(2 * xy, xx - yy) / 2,
                0, 2 * Math.PI);
    pen.stroke();
    pen.setLineDash([]);
  }

  function robot(pen, [x, y, yaw], X, Y, view, colour) {
    const half = setup.separation / 2 * view.scale, wheel = setup.radius * view.scale;
    pen.save();
    pen.translate(X(x), Y(y));
    pen.rotate(-yaw);
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = 2;
    pen.globalAlpha = 0.18;
    pen.beginPath(); pen.arc(0, 0, half, 0, 2 * Math.PI); pen.fill();
    pen.globalAlpha = 1;
    pen.beginPath(); pen.arc(0, 0, half, 0, 2 * Math.PI);
    pen.moveTo(0, 0); pen.lineTo(half, 0); pen.stroke();
    for (const side of [-half, half]) pen.fillRect(-wheel, side - wheel / 4, 2 * wheel, wheel / 2);
    pen.restore();
  }

  // ------------------------------------------------------------------ words and plots
  const text = (id, value) => {
    const element = byId(id);
    if (element && element.textContent !== value) element.textContent = value;
  };

  function words(c) {
    const said = state.lost ? 'connection lost'
      : !state.belief ? 'waiting for odometry'
      : state.stopped ? 'emergency stop'
      : state.driver ? (state.driver === setup.viewer ? 'you drive' : 'another viewer drives') : '';
    text('dd-state', [said, state.notice].filter(Boolean).join(' \u2014 '));
    const pose = (p) => `x ${p[0].toFixed(3)} m, y ${p[1].toFixed(3)} m, `
      + `yaw ${(p[2] * 180 / Math.PI).toFixed(1)}°`;
    const legend = byId('dd-legend');
    if (!legend) return;
    if (!legend.children.length) legend.innerHTML = '<p id="dd-belief"></p><p id="dd-truth"></p>';
    byId('dd-belief').style.color = c.belief;
    byId('dd-truth').style.color = c.truth;
    text('dd-belief', state.belief ? `belief: ${pose(state.belief)}` : '');
    text('dd-truth', state.truth ? `truth: ${pose(state.truth)}` : '');
    const health = byId('dd-health');
    if (health && state.status) {
      health.replaceChildren(...state.status.map(([level, name, message]) => {
        const row = document.createElement('p');
        row.className = `dd-level-${level}`;
        row.textContent = `${name}: ${message}`;
        return row;
      }));
      state.status = null;
    }
  }

  function plots(c) {
    const place = byId('dd-plots');
    if (!place) return;
    if (!place.children.length) {
      place.innerHTML = PLOTS.map(([name]) =>
        `<div class="dd-plot"><p id="dd-${name}"></p><canvas id="dd-plot-${name}"></canvas></div>`).join('');
    }
    for (const [name, label, colour] of PLOTS) {
      const points = state.plots[name] || [];
      place.children[PLOTS.findIndex((p) => p[0] === name)].hidden = !points.length;
      if (!points.length) continue;
      const last = points[points.length - 1], values = points.map((p) => p[1]);
      text(`dd-${name}`, `${label}: ${last[1].toFixed(name === 'speed' ? 3 : 2)}`);
      const [pen, w, h] = sized(byId(`dd-plot-${name}`));
      const low = Math.min(0, ...values), high = Math.max(1e-3, ...values);
      line(pen, points, (t) => w * (1 - (last[0] - t) / PLOT_S),
           (v) => h - 2 - (h - 4) * (v - low) / (high - low), c[colour], 1.5);
    }
  }

  // ------------------------------------------------------------------ driving
  const KEYS = {ArrowUp: [1, 0], w: [1, 0], ArrowDown: [-1, 0], s: [-1, 0],
                ArrowLeft: [0, 1], a: [0, 1], ArrowRight: [0, -1], d: [0, -1]};
  const held = new Set();
  let stick = [0, 0], driving = false;

  function wanted() {
    let [v, w] = stick;
    for (const key of held) { v += KEYS[key][0]; w += KEYS[key][1]; }
    return [Math.max(-1, Math.min(1, v)), Math.max(-1, Math.min(1, w))];
  }

  function drive() {  // zeros go once, at once: from then on the robot stands
    const [v, w] = wanted(), moving = v !== 0 || w !== 0;
    if (moving || driving) act('drive', [v, w]);
    driving = moving;
  }

  function release() {
    held.clear();
    stick = [0, 0];
    const knob = document.querySelector('#dd-pad i');
    if (knob) knob.style.transform = '';
    drive();
  }

  const keyOf = (event) => event.key.length === 1 ? event.key.toLowerCase() : event.key;
  addEventListener('keydown', (event) => {
    const key = keyOf(event);
    if (!(key in KEYS) || event.ctrlKey || event.metaKey || event.altKey
        || event.target.closest('input, textarea, .q-slider')) return;
    event.preventDefault();
    if (!held.has(key)) { held.add(key); drive(); }
  });
  addEventListener('keyup', (event) => { if (held.delete(keyOf(event))) drive(); });
  addEventListener('blur', release);
  addEventListener('pagehide', release);
  document.addEventListener('visibilitychange', () => { if (document.hidden) release(); });
  setInterval(() => { if (driving) drive(); }, SEND_MS);

  function pad(element) {
    const knob = element.querySelector('i');
    const move = (event) => {
      const box = element.getBoundingClientRect(), r = box.width / 2;
      let x = (event.clientX - box.left - r) / r, y = (event.clientY - box.top - r) / r;
      const size = Math.max(1, Math.hypot(x, y));
      x /= size; y /= size;
      stick = [-y, -x];
      knob.style.transform = `translate(${x * r}px, ${y * r}px)`;
      drive();
    };
    element.onpointerdown = (event) => { element.setPointerCapture(event.pointerId); move(event); };
    element.onpointermove = (event) => { if (element.hasPointerCapture(event.pointerId)) move(event); };
    element.onpointerup = element.onpointercancel = element.onlostpointercapture = release;
  }

  // ------------------------------------------------------------------ drag, zoom and click
  function navigate(canvas) {
    const fingers = new Map();
    let moved = 0, pinch = 0;
    const zoom = (factor, px, py) => {
      const view = state.view, x = (px - canvas.clientWidth / 2) / view.scale;
      const y = (canvas.clientHeight / 2 - py) / view.scale;
      const scale = Math.max(1, Math.min(20000, view.scale * factor)), kept = view.scale / scale;
      Object.assign(view, {x: view.x + x * (1 - kept), y: view.y + y * (1 - kept), scale, own: true});
      draw();
    };
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      zoom(Math.exp(-event.deltaY / 500), event.offsetX, event.offsetY);
    }, {passive: false});
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, event);
      moved = fingers.size > 1 ? Infinity : 0;
      pinch = 0;
    };
    canvas.onpointermove = (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      fingers.set(event.pointerId, event);
      if (fingers.size === 2) {
        const [a, b] = [...fingers.values()], box = canvas.getBoundingClientRect();
        const apart = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        if (pinch) zoom(apart / pinch, (a.clientX + b.clientX) / 2 - box.left,
                        (a.clientY + b.clientY) / 2 - box.top);
        pinch = apart;
        return;
      }
      moved += Math.hypot(dx, dy);
      if (moved < CLICK_PX) return;
      const view = state.view;
      Object.assign(view, {x: view.x - dx / view.scale, y: view.y + dy / view.scale, own: true});
      draw();
    };
    canvas.onpointerup = (event) => {
      if (fingers.delete(event.pointerId) && moved < CLICK_PX) {
        const view = state.view;
        act('goal', [view.x + (event.offsetX - canvas.clientWidth / 2) / view.scale,
                     view.y + (canvas.clientHeight / 2 - event.offsetY) / view.scale]);
      }
    };
    canvas.onpointercancel = (event) => fingers.delete(event.pointerId);
  }

  const begin = setInterval(() => {  // the elements are made by scripts that load by themselves
    const [map, stickPad, button] = [byId('dd-map'), byId('dd-pad'), byId('dd-fit')];
    if (!map || !stickPad || !button) return;
    clearInterval(begin);
    navigate(map);
    pad(stickPad);
    button.onclick = () => { state.view.own = false; draw(); };
    addEventListener('resize', draw);
    dark.addEventListener('change', draw);
    connect();
    draw();
  }, 50);
  window.webView = state;  // for who looks from the console, and for tests
})();
