// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Things that are anchored to keyframes: their vertices carry the keyframe's slot, and the vertex shader looks the pose
// up in a texture. After a loop closure only that texture changes, a few bytes per keyframe.

import * as THREE from "/three/build/three.module.js";
import { kFirstSlots, kPoseValues } from "./world.js";

const kTexelsPerSlot = kPoseValues / 4;
const kRowTexels = kFirstSlots * kTexelsPerSlot;

const kLookUp = `
  uniform sampler2D poses;
  uniform float poseRows;
  attribute float slot;
  vec4 texel(float index) {
    float row = floor((index + 0.5) / ${kRowTexels}.0);
    float column = index - row * ${kRowTexels}.0;
    return texture2D(poses, vec2((column + 0.5) / ${kRowTexels}.0, (row + 0.5) / poseRows));
  }
  vec3 rotate(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`;

const kPointVertex = `
  ${kLookUp}
  attribute float rated;      // static probability, in the lower byte
  uniform float size;
  uniform int coloring;
  uniform vec2 heightRange;
  uniform vec3 plainColor;
  uniform vec3 ramp[5];
  uniform vec3 movingColor;
  varying vec3 tint;
  vec3 colorOfHeight(float y) {
    float t = 4.0 * clamp((heightRange.y - y) / (heightRange.y - heightRange.x), 0.0, 1.0);
    vec3 color = mix(ramp[0], ramp[1], clamp(t, 0.0, 1.0));
    color = mix(color, ramp[2], clamp(t - 1.0, 0.0, 1.0));
    color = mix(color, ramp[3], clamp(t - 2.0, 0.0, 1.0));
    return mix(color, ramp[4], clamp(t - 3.0, 0.0, 1.0));
  }
  void main() {
    vec4 translation = texel(${kTexelsPerSlot}.0 * slot);
    if (slot < 0.0 || translation.w == 0.0) {
      gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
      gl_PointSize = 1.0;
      return;
    }
    vec4 q = texel(${kTexelsPerSlot}.0 * slot + 1.0);
    vec3 p_world = translation.xyz + rotate(q, position * translation.w);
    float staticProbability = mod(rated, 256.0) / 255.0;
    tint = coloring == 0 ? colorOfHeight(p_world.y)
         : coloring == 1 ? mix(movingColor, plainColor, staticProbability) : plainColor;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(p_world, 1.0);
    gl_PointSize = size;
  }
`;

const kLineVertex = `
  ${kLookUp}
  uniform float scale;
  uniform vec3 plainColor;
  attribute vec3 own;
  uniform bool colored;
  varying vec3 tint;
  void main() {
    vec3 p_world = texel(${kTexelsPerSlot}.0 * slot).xyz + rotate(texel(${kTexelsPerSlot}.0 * slot + 1.0), position * scale);
    tint = colored ? own : plainColor;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(p_world, 1.0);
  }
`;

const kFragment = `
  uniform float opacity;
  varying vec3 tint;
  void main() { gl_FragColor = vec4(tint, opacity); }
`;

/** The poses of one map as a texture that all its materials share. */
export class PoseTexture {
  constructor(map) {
    this.map = map;
    this.uniforms = { poses: { value: null }, poseRows: { value: 1 } };
    this.update();
  }

  update() {
    const { poses } = this.map;
    if (this.array !== poses) this.#replace(poses);
    this.uniforms.poses.value.needsUpdate = true;
  }

  #replace(poses) {
    this.dispose();
    this.array = poses;
    const rows = poses.length / (4 * kRowTexels);
    this.uniforms.poses.value = new THREE.DataTexture(poses, kRowTexels, rows, THREE.RGBAFormat, THREE.FloatType);
    this.uniforms.poseRows.value = rows;
  }

  dispose() {
    this.uniforms.poses.value?.dispose();
  }
}

/** look: uniforms that all points of the page share (size, coloring, ramp, ...). */
export function pointMaterial(poseTexture, look, heightRange) {
  return new THREE.ShaderMaterial({
    uniforms: { ...poseTexture.uniforms, ...look, heightRange, opacity: { value: 1 } },
    vertexShader: kPointVertex, fragmentShader: kFragment,
  });
}

/** Lines whose vertices are positions in the frames of their keyframes. color: a uniform, {value: THREE.Color}; colored: a
    uniform, {value: whether the vertices have colours of their own}. */
export function lineMaterial(poseTexture, color, { opacity = 1, scale = { value: 1 }, colored = { value: false } } = {}) {
  return new THREE.ShaderMaterial({
    uniforms: { ...poseTexture.uniforms, plainColor: color, opacity: { value: opacity }, scale, colored },
    vertexShader: kLineVertex, fragmentShader: kFragment, transparent: opacity < 1, depthWrite: opacity === 1,
  });
}
