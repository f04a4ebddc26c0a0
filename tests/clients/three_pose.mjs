// three.js plays a GLB: world positions of every joint, and of some vertices, at given times.
//   node three_pose.mjs FILE TIME [TIME ...]
import { readFileSync } from "node:fs";
import * as THREE from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";

globalThis.self ??= globalThis; // the loader expects a browser's name for it
const [file, ...times] = process.argv.slice(2);
const bytes = readFileSync(file);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const gltf = await new GLTFLoader().parseAsync(buffer, "");
const mixer = new THREE.AnimationMixer(gltf.scene);
for (const clip of gltf.animations) {
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
}

const skinned = [];
gltf.scene.traverse((node) => node.isSkinnedMesh && skinned.push(node));
const frames = times.map((time) => {
  mixer.setTime(Number(time));
  gltf.scene.updateMatrixWorld(true);
  const joints = {};
  for (const bone of new Set(skinned.flatMap((mesh) => mesh.skeleton.bones))) {
    joints[bone.name] = bone.getWorldPosition(new THREE.Vector3()).toArray();
  }
  const vertices = skinned.map((mesh) => {
    const count = mesh.geometry.attributes.position.count;
    return [0, count >> 1, count - 1].map((index) =>
      mesh.getVertexPosition(index, new THREE.Vector3()).applyMatrix4(mesh.matrixWorld).toArray(),
    );
  });
  return { joints, vertices };
});
console.log(JSON.stringify(frames));
