export { WebGLRenderer, Scene, PerspectiveCamera, Color, AmbientLight, HemisphereLight, DirectionalLight, Plane, Vector3, Box3, Mesh, MeshBasicMaterial, MeshStandardMaterial, BufferAttribute, DoubleSide, FrontSide, BackSide, Raycaster, Vector2, LineSegments, LineBasicMaterial, WireframeGeometry, Group, Quaternion } from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
export { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
