'use strict';
// Draws both surfaces with K3D, with one camera. Without WebGL 2 the page keeps its numbers.
(() => {
  const FIELD_OF_VIEW = 35;
  const HOT = ['#e9ecef', '#f3d38a', '#e8813d', '#a31f34'];  // from what is fine to what a person should look at
  const FEWER = ['#e9ecef', '#86b6e6', '#3a7bc4', '#173f7a'], MORE = ['#e9ecef', '#efbd52', ...HOT.slice(2)];
  const PATCHES = ['#9ecae1', '#fdd0a2', '#a1d99b', '#dadaeb', '#fbb4c4', '#d9d2a8', '#9fd8d0', '#c7c7cf'];
  const PLAIN = '#d3dae0', GAP = '#e8813d', BORDER = '#c2188b', MANY = '#c81e1e', CURVE = '#15181b', HERE = '#d6006e';
  const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

  const data = JSON.parse(document.getElementById('data').textContent);
  const middle = data.box.map((length) => length / 2);

  const unpack = (text) => {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
    return fflate.unzlibSync(bytes);
  };
  const unpacked = (text, Type) => (text ? new Type(unpack(text).slice().buffer) : null);
  const number = (color) => parseInt(color.slice(1), 16);
  const parts = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);
  const ramp = (colors) => new Float32Array(colors.flatMap((color, i) => [i / (colors.length - 1), ...parts(color)]));
  const steps = (colors) => new Float32Array(colors.flatMap(
      (color, i) => [[i / colors.length, ...parts(color)], [(i + 0.999) / colors.length, ...parts(color)]]).flat());
  const held = (values) => ({data: values, shape: [values.length]});
  const rows = (values, width) => ({data: values, shape: [values.length / width, width]});
  const checked = (name) => document.querySelector(`input[name=${name}]:checked`).value;

  function readSide(packed) {
    const short = unpacked(packed.positions, Uint16Array);
    return {
      positions: Float32Array.from(short, (value) => value / 65535),
      faces: unpacked(packed.faces, Uint32Array),
      poorness: unpacked(packed.poorness, Uint8Array),
      fewer: unpacked(packed.fewer, Uint8Array),
      more: unpacked(packed.more, Uint8Array),
      gap: unpacked(packed.gap, Uint8Array),
      deviation: unpacked(packed.deviation, Uint8Array),
      patch: unpacked(packed.patch, Uint8Array),
      regions: unpacked(packed.regions, Uint16Array),
      border: unpacked(packed.border, Uint32Array),
      nonmanifold: unpacked(packed.nonmanifold, Uint32Array),
      curve: unpacked(packed.curve, Uint32Array),
    };
  }

  const mesh = (side, more) => ({
    type: 'Mesh', visible: true, color: number(PLAIN), opacity: 1, wireframe: false, flat_shading: true, side: 'double',
    roughness: 0.9, metalness: 0, vertices: rows(side.positions, 3), indices: rows(side.faces, 3),
    model_matrix: {data: IDENTITY, shape: [4, 4]}, ...more,
  });
  const colored = (colors) => ({colors: held(colors), color: 0xffffff});
  const byVertex = (values, colors, top) => ({
    attribute: held(Float32Array.from(values)), color_map: held(ramp(colors)), color_range: [0, top], color: 0xffffff,
  });
  const valenceColor = (side, i) => number(side.fewer[i] ? FEWER[side.fewer[i]] : MORE[side.more[i]]);

  const hidden = new Set();  // regions, by number
  const apart = () => Number(document.getElementById('apart').value) / 50;  // times the way of each region

  // The closed surface of each region that is shown, moved away from the middle: the faces behind which it lies, and
  // those in front of which it does, turned. Faces are drawn from outside alone, so that of two in one place one shows.
  function pulled(side) {
    const of = data.regions.map(() => []);
    for (let f = 0; 3 * f < side.faces.length; f++) {
      const [a, b, c] = side.faces.subarray(3 * f, 3 * f + 3), [behind, front] = side.regions.subarray(2 * f, 2 * f + 2);
      if (behind && !hidden.has(behind)) of[behind - 1].push(a, b, c);
      if (front && !hidden.has(front)) of[front - 1].push(a, c, b);
    }
    const positions = [], faces = [], colors = [], way = apart();
    of.forEach((corners, region) => {
      const place = new Map(), {away, color} = data.regions[region], painted = number(color);
      for (const v of corners) {
        if (!place.has(v)) {
          place.set(v, positions.length / 3);
          for (let axis = 0; axis < 3; axis++) positions.push(side.positions[3 * v + axis] + way * away[axis]);
          colors.push(painted);
        }
        faces.push(place.get(v));
      }
    });
    return {positions: new Float32Array(positions), faces: new Uint32Array(faces), colors: new Uint32Array(colors)};
  }

  // Edges of a dense mesh would hide its colours.
  const wireOpacity = (side) => 0.3 * Math.min(1, Math.sqrt(30000 / side.faces.length));

  const MODES = {
    regions: {
      has: (side) => side.regions,
      paint: (side) => ({...colored(side.colors), side: 'front'}),
      legend: () => '',  // buttons, by listRegions
    },
    shape: {has: () => true, paint: () => ({}), legend: () => ''},
    deviation: {
      has: (side) => side.deviation,
      paint: (side) => byVertex(side.deviation, HOT, 255),
      legend: () => 'Distance of vertices to the other mesh, world units, the input as it was read: 0 '
          + `${bar(HOT)} ${data.top} and more; largest ${data.largest}`,
    },
    quality: {
      has: (side) => side.poorness,
      paint: (side) => ({
        triangles_attribute: held(Float32Array.from(side.poorness)), color_map: held(ramp(HOT)),
        color_range: [0, 255], color: 0xffffff,
      }),
      legend: () => `Quality: 1, equilateral ${bar(HOT)} 0, without area`,
    },
    valence: {
      has: (side) => side.fewer,
      paint: (side) => colored(Uint32Array.from(side.fewer, (_, i) => valenceColor(side, i))),
      legend: () => ['Neighbours of a vertex:', swatch(FEWER[3], '3 or fewer'), swatch(FEWER[2], '4'),
        swatch(FEWER[1], '5'), swatch(HOT[0], '6'), swatch(MORE[1], '7'), swatch(MORE[2], '8'),
        swatch(MORE[3], '9 or more')].join(' '),
    },
    gaps: {
      has: (side) => side.gap || side.border || side.nonmanifold,
      paint: (side) => (side.gap ? colored(Uint32Array.from(side.gap, (gap) => number(gap ? GAP : PLAIN))) : {}),
      legend: () => [swatch(GAP, 'where the input has no surface'), swatch(BORDER, 'borders'),
        swatch(MANY, 'edges of three faces or more')].join(' '),
    },
    creases: {
      has: (side) => side.curve || side.patch,
      paint: (side) => (side.patch ? {
        triangles_attribute: held(Float32Array.from(side.patch, (patch) => patch + 0.5)),
        color_map: held(steps(PATCHES)), color_range: [0, PATCHES.length], color: 0xffffff,
      } : {}),
      legend: () => swatch(CURVE, 'curves that the result keeps')
          + ' A colour for each patch between them, some more than once.',
    },
  };
  const bar = (colors) => `<span class="ramp" style="background:linear-gradient(90deg,${colors})"></span>`;
  const swatch = (color, words) => `<span><i class="swatch" style="background:${color}"></i>${words}</span>`;

  // Of tubes along edges: thin where these are short.
  function widthOf({positions}, ends) {
    let sum = 0;
    for (let i = 0; i < ends.length; i += 2) {
      sum += Math.hypot(...[0, 1, 2].map((axis) => positions[3 * ends[i] + axis] - positions[3 * ends[i + 1] + axis]));
    }
    return Math.min(0.0035, Math.max(0.0012, 0.2 * sum / (ends.length / 2)));
  }

  function tubes(id, side, ends, color) {
    const many = ends.length > 8000;
    return {
      type: 'Lines', id, visible: true, color: number(color), shader: many ? 'simple' : 'mesh',
      width: widthOf(side, ends), radial_segments: 6, opacity: 1, indices_type: 'segment',
      vertices: rows(side.positions, 3), indices: rows(ends, 2),
      colors: held(new Uint32Array(0)), attribute: held(new Float32Array(0)), color_map: held(new Float32Array(0)),
      color_range: [], model_matrix: {data: IDENTITY, shape: [4, 4]},
    };
  }

  class View {
    constructor(library, name, side, curves) {
      this.side = side;
      this.curves = curves;
      const target = document.getElementById(name);
      this.plot = new library.K3D(library.ThreeJsProvider, target, {
        menuVisibility: false, cameraAutoFit: false, gridVisible: false, gridAutoFit: false, axesHelper: 0,
        colorbarObjectId: 0, cameraFov: FIELD_OF_VIEW, cameraDampingFactor: 0, lighting: 1.55,
        renderOnChange: true, clearColor: paneColor(),
      });
      this.shown = new Set();
    }

    load(objects) {
      objects.forEach((object) => this.shown.add(object.id));
      return this.plot.load({objects});
    }

    async paint(mode, edges) {
      const kind = MODES[mode];
      const side = mode === 'regions' && this.side.regions ? pulled(this.side) : this.side;
      const isEmpty = side.faces.length === 0;  // all regions are hidden
      const objects = isEmpty ? [] : [mesh(side, {id: 1, ...(kind.has(this.side) ? kind.paint(side) : {})})];
      const wires = {id: 2, wireframe: true, color: 0x0b1116, opacity: wireOpacity(this.side)};
      if (edges && !isEmpty) objects.push(mesh(side, wires));
      if (mode === 'gaps' && this.side.border) objects.push(tubes(3, this.side, this.side.border, BORDER));
      if (mode === 'gaps' && this.side.nonmanifold) objects.push(tubes(4, this.side, this.side.nonmanifold, MANY));
      if (mode === 'creases' && this.curves) objects.push(tubes(5, this.curves, this.curves.curve, CURVE));
      const kept = new Set(objects.map((object) => object.id));
      for (const id of [1, 2, 3, 4, 5]) {
        if (this.shown.has(id) && !kept.has(id)) { this.shown.delete(id); await this.plot.removeObject(id); }
      }
      await this.load(objects);
    }

    mark(place) {
      return this.load([{
        type: 'Points', id: 9, visible: true, positions: rows(Float32Array.from(place.at), 3), color: number(HERE),
        point_size: place.distance * 0.02, shader: '3d', opacity: 1, colors: held(new Uint32Array(0)),
        model_matrix: {data: IDENTITY, shape: [4, 4]},
      }]);
    }
  }

  const paneColor = () => number(getComputedStyle(document.documentElement).getPropertyValue('--pane').trim());

  function axes() {
    const up = {x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1]}[checked('up')];
    const front = {x: [0, 1, 0.45], y: [0.45, 0.3, 1], z: [0.45, -1, 0.35]}[checked('up')];
    return {up, front};
  }

  function camera(target, direction, distance) {
    const length = Math.hypot(...direction);
    let {up} = axes();
    if (Math.abs(dot(up, direction)) > 0.97 * length) up = [up[2], up[0], up[1]];
    return [...target.map((x, i) => x + direction[i] / length * distance), ...target, ...up];
  }

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((x) => x / Math.hypot(...a));

  // From which all of these points are in view.
  function distanceThatShows(points, {up, front}, aspect) {
    const slope = Math.tan(FIELD_OF_VIEW / 2 * Math.PI / 180), back = unit(front), right = unit(cross(up, back));
    const above = cross(back, right);
    let distance = 0;
    for (const point of points) {
      const across = Math.max(Math.abs(dot(point, above)), Math.abs(dot(point, right)) / aspect);
      distance = Math.max(distance, dot(point, back) + across / slope);
    }
    return 1.06 * distance;
  }

  // At most so many of the positions, from the middle on.
  function someOf(positions, most) {
    const stride = 3 * Math.ceil(positions.length / 3 / most), found = [];
    for (let i = 0; i < positions.length; i += stride) found.push(middle.map((m, axis) => positions[i + axis] - m));
    return found;
  }

  // A button for each region, which hides and shows it.
  function listRegions(change) {
    const list = document.createElement('div');
    list.className = 'regions';
    data.regions.forEach(({words, color}, i) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.dataset.region = i;
      button.innerHTML = swatch(color, '');
      button.append(words);
      button.setAttribute('aria-pressed', !hidden.has(i + 1));
      button.addEventListener('click', () => {
        if (!hidden.delete(i + 1)) hidden.add(i + 1);
        button.setAttribute('aria-pressed', !hidden.has(i + 1));
        change();
      });
      list.append(button);
    });
    document.getElementById('legend').replaceChildren(list);
  }

  // Calls it again where it was called while it ran, once: a slider moves faster than meshes are drawn.
  function oneAtATime(work) {
    let running = false, again = false;
    return async () => {
      again = true;
      if (running) return;
      running = true;
      while (again) { again = false; await work(); }
      running = false;
    };
  }

  function start(library) {
    const sides = Object.fromEntries(Object.entries(data.sides).map(([name, packed]) => [name, readSide(packed)]));
    const curves = sides.after.curve ? sides.after : null;  // the result's lie on the input, too
    const views = Object.entries(sides).map(([name, side]) => new View(library, name, side, curves));
    const pointsOf = (shown) => Object.values(sides).flatMap((side) => someOf(shown(side).positions, 3000));
    const together = pointsOf((side) => side);

    let following = false;
    const look = (to) => {
      following = true;
      for (const view of views) { view.plot.setCamera(to); view.plot.render(); }
      following = false;
    };
    for (const view of views) {
      view.plot.on(view.plot.events.CAMERA_CHANGE, (to) => {
        if (following) return;
        following = true;
        for (const other of views) if (other !== view) { other.plot.setCamera(to); other.plot.render(); }
        following = false;
      });
    }
    const wide = () => {
      const {clientWidth, clientHeight} = document.querySelector('.view');
      const isApart = checked('mode') === 'regions' && apart() > 0;
      const points = isApart ? pointsOf((side) => (side.regions ? pulled(side) : side)) : together;
      look(camera(middle, axes().front, distanceThatShows(points, axes(), clientWidth / clientHeight)));
    };
    const paint = () => {
      const mode = checked('mode');
      if (mode === 'regions') listRegions(redraw);
      else document.getElementById('legend').innerHTML = MODES[mode].legend();
      document.getElementById('pull').hidden = mode !== 'regions';
      return draw();
    };
    const draw = () => {
      const mode = checked('mode');
      return Promise.all(views.map((view) => view.paint(mode, document.getElementById('edges').checked)));
    };
    const redraw = oneAtATime(draw);
    document.getElementById('apart').addEventListener('input', redraw);
    const press = (pressed) => {
      for (const button of document.querySelectorAll('[data-place]')) {
        button.setAttribute('aria-pressed', button === pressed);
      }
    };

    for (const input of document.querySelectorAll('input[name=mode]')) {
      const offered = views.some((view) => MODES[input.value].has(view.side));
      input.closest('label').hidden = !offered;
      input.addEventListener('change', paint);
    }
    for (const input of document.querySelectorAll('input[name=up]')) input.addEventListener('change', wide);
    document.getElementById('edges').addEventListener('change', paint);
    document.getElementById('reset').addEventListener('click', () => { press(null); wide(); });
    for (const button of document.querySelectorAll('[data-place]')) {
      button.addEventListener('click', () => {
        const place = data.places[button.dataset.place];
        press(button);
        look(camera(place.at, place.from, place.distance));
        document.getElementById('look').scrollIntoView({block: 'start'});
        views.forEach((view) => view.mark(place));
      });
    }
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      for (const view of views) { view.plot.setClearColor(paneColor()); view.plot.render(); }
    });
    window.isoshellReport = {views};
    return paint().then(() => { wide(); document.body.dataset.drawn = 'yes'; });
  }

  function hasWebGl() {
    const context = document.createElement('canvas').getContext('webgl2');
    context?.getExtension('WEBGL_lose_context')?.loseContext();
    return Boolean(context);
  }

  if (!hasWebGl()) {
    for (const button of document.querySelectorAll('[data-place]')) button.disabled = true;
    return;
  }
  document.getElementById('unseen').hidden = true;
  document.getElementById('look').hidden = false;
  let library = null;
  window.define = (name, needs, make) => { library = make(); };  // how its one script hands K3D over
  const script = document.createElement('script');
  script.textContent = fflate.strFromU8(unpack(document.getElementById('k3d').textContent));
  document.head.appendChild(script);
  start(library);
})();
