// The page that `trisect ... -o result.html` writes: shows the model that is in it. Nothing is asked of any other place.
'use strict';
(async () => {
  const element = (id) => document.getElementById(id);
  const data = JSON.parse(element('data').textContent);
  const bytesOf = (id) => {
    const text = atob(element(id).textContent.trim());
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    element(id).remove();
    return bytes;
  };

  // 1. What is told of the model; it stands there even where nothing can be drawn.
  for (const [name, value] of data.facts) {
    const row = element('facts').insertRow();
    const head = document.createElement('th');
    head.textContent = name;
    row.append(head);
    row.insertCell().textContent = value;
  }

  // 2. The library: unpacked, and run as a script of this page.
  const unpacked = new Blob([bytesOf('library')]).stream().pipeThrough(new DecompressionStream('gzip'));
  const library = document.createElement('script');
  library.textContent = await new Response(unpacked).text() + '\nwindow.THREE = THREE;';
  document.head.append(library);
  const { THREE } = window;

  // 3. The scene: the model, and light that goes with the eye.
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.localClippingEnabled = true;
  renderer.setPixelRatio(window.devicePixelRatio);
  element('view').append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color('#eef0f4');
  const camera = new THREE.PerspectiveCamera(40, 1, 0.01, 1000);
  camera.up.set(...data.up);
  const light = new THREE.DirectionalLight('#ffffff', 2.2);
  light.position.set(0.4, 0.7, 1);
  camera.add(light, light.target);
  light.target.position.set(0, 0, -1);
  scene.add(camera, new THREE.HemisphereLight('#ffffff', '#99a0b0', 1.3));
  const { scene: model } = await new THREE.GLTFLoader().parseAsync(bytesOf('model').buffer, '');
  scene.add(model);
  const box = new THREE.Box3().setFromObject(model);
  if (box.isEmpty()) box.set(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
  const middle = box.getCenter(new THREE.Vector3());
  const size = Math.max(box.getSize(new THREE.Vector3()).length(), 1e-30);
  // Coordinates near one: what is far from the origin, huge or tiny is drawn as well as what is not.
  const placed = new THREE.Group();
  placed.scale.setScalar(1 / size);
  placed.position.copy(middle).multiplyScalar(-1 / size);
  placed.add(model);
  scene.add(placed);

  // 4. Every mesh in each of the ways to colour it, and its inner side, which a section lays open.
  const cut = new THREE.Plane();
  const meshes = [];
  model.traverse((node) => { if (node.isMesh) meshes.push(node); });
  const wires = [false, true].map((vertexColors) => new THREE.MeshBasicMaterial(
    { color: vertexColors ? '#ffffff' : '#445', wireframe: true, vertexColors }));
  const inner = new THREE.MeshBasicMaterial({ color: '#c2703d', side: THREE.BackSide, clippingPlanes: [cut] });
  const colourOf = {
    operand: (code) => data.palette[(code >> 1) % data.palette.length],
    cut: (code) => (code & 1 ? '#e07b39' : '#b9c2d0'),
  };
  for (const mesh of meshes) {
    const { geometry } = mesh;
    const flatShading = !geometry.attributes.normal;
    mesh.userData.material = mesh.material;
    mesh.userData.plain = new THREE.MeshStandardMaterial({ color: '#b9c2d0', roughness: 0.8, flatShading });
    const codes = geometry.attributes._operand;
    for (const way of codes ? ['operand', 'cut'] : []) {
      const colour = new THREE.Color();
      const colours = new Float32Array(3 * codes.count);
      for (let i = 0; i < codes.count; i++) colour.set(colourOf[way](Math.round(codes.getX(i)))).toArray(colours, 3 * i);
      mesh.userData[way] = {
        colours: new THREE.BufferAttribute(colours, 3),
        material: new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.8, flatShading }),
      };
    }
    mesh.userData.own = geometry.attributes.color;
    const back = new THREE.Mesh(geometry, inner);
    back.visible = false;
    back.name = 'inner';
    mesh.add(back);
  }

  // 5. What the panel does.
  let way = 'material';
  let axis = '';
  const draw = () => renderer.render(scene, camera);
  const dress = () => {
    for (const mesh of meshes) {
      const shown = mesh.userData[way] || mesh.userData.material;
      const colours = shown.colours || mesh.userData.own;
      mesh.material = element('wire').checked ? wires[Number(Boolean(shown.colours))] : shown.material || shown;
      if (colours) mesh.geometry.setAttribute('color', colours); else mesh.geometry.deleteAttribute('color');
      for (const material of [].concat(mesh.material)) {
        material.clippingPlanes = axis ? [cut] : [];
        material.needsUpdate = true;
      }
      mesh.children.filter((child) => child.name === 'inner').forEach((back) => {
        back.visible = axis !== '' && !element('wire').checked;
      });
    }
    draw();
  };
  const section = () => {
    element('place').disabled = axis === '';
    element('at').textContent = '';
    if (axis) {
      const share = element('place').value / 1000;
      const at = box.min[axis] + share * (box.max[axis] - box.min[axis]);
      const side = element('flip').checked ? 1 : -1;
      cut.normal.set(0, 0, 0);
      cut.normal[axis] = side;
      cut.constant = -side * (at - middle[axis]) / size;
      element('at').textContent = `${axis} = ${Number(at.toPrecision(6))}`;
    }
    dress();
  };
  const ways = [['material', 'Material'], ['plain', 'One colour']];
  if (meshes.some((mesh) => mesh.userData.operand)) ways.unshift(['operand', 'Input'], ['cut', 'Cut faces']);
  for (const [name, label] of ways) {
    const line = document.createElement('label');
    const choice = document.createElement('input');
    Object.assign(choice, { type: 'radio', name: 'way', value: name, checked: name === data.way });
    choice.addEventListener('change', () => { way = name; dress(); });
    line.append(choice, ` ${label}`);
    element('colours').append(line);
  }
  way = ways.some(([name]) => name === data.way) ? data.way : 'material';
  element('wire').addEventListener('change', dress);
  element('flip').addEventListener('change', section);
  element('place').addEventListener('input', section);
  for (const choice of document.getElementsByName('axis')) {
    choice.addEventListener('change', () => { axis = choice.value; section(); });
  }

  // 6. The eye.
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.addEventListener('change', draw);
  const fit = () => {
    const distance = 0.62 / Math.tan(camera.fov * Math.PI / 360) * Math.max(1, 1 / camera.aspect);
    controls.target.set(0, 0, 0);
    camera.position.set(...data.from).setLength(distance);
    controls.update();
    draw();
  };
  const resize = () => {
    const { clientWidth: width, clientHeight: height } = element('view');
    renderer.setSize(width, height);
    camera.aspect = width / Math.max(height, 1);
    camera.updateProjectionMatrix();
    draw();
  };
  element('fit').addEventListener('click', fit);
  window.addEventListener('resize', resize);
  resize();
  fit();
  section();
  document.body.dataset.ready = 'yes';
})().catch((error) => {
  const fault = document.getElementById('fault');
  fault.hidden = false;
  fault.textContent = `The model cannot be shown: ${error.message || error}. A browser of 2023 or later with WebGL is needed.`;
  console.error(error);
});
