// The WebGL code of the drive: one program for lit triangles, and buffers of triangles.

import { STRIDE, type Mesh } from "./mesh.ts";

const VERTEX = `#version 300 es
uniform mat4 matrix;
in vec3 position;
in vec3 normal;
in vec4 colour;
out vec4 shade;
void main() {
  float light = 0.74 + 0.26 * max(dot(normalize(normal), normalize(vec3(-0.35, 0.55, 0.76))), 0.0);
  shade = vec4(colour.rgb * light, colour.a);
  gl_Position = matrix * vec4(position, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision mediump float;
in vec4 shade;
out vec4 fragment;
void main() { fragment = vec4(shade.rgb * shade.a, shade.a); }`;

/** A mesh on the graphics card. */
export interface Drawn {
  buffer: WebGLBuffer;
  array: WebGLVertexArrayObject;
  vertices: number;
}

export function upload(gl: WebGL2RenderingContext, made: WebGLProgram, mesh: Mesh): Drawn {
  const drawn = { buffer: gl.createBuffer(), array: gl.createVertexArray(), vertices: mesh.vertices };
  gl.bindVertexArray(drawn.array);
  refill(gl, drawn, mesh);
  const parts: [string, number, number][] = [["position", 3, 0], ["normal", 3, 3], ["colour", 4, 6]];
  for (const [name, size, from] of parts) {
    const at = gl.getAttribLocation(made, name);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, STRIDE * 4, from * 4);
  }
  gl.bindVertexArray(null);
  return drawn;
}

export function refill(gl: WebGL2RenderingContext, drawn: Drawn, mesh: Mesh): void {
  gl.bindBuffer(gl.ARRAY_BUFFER, drawn.buffer);
  gl.bufferData(gl.ARRAY_BUFFER, mesh.data, gl.DYNAMIC_DRAW);
  drawn.vertices = mesh.vertices;
}

export function remove(gl: WebGL2RenderingContext, { buffer, array }: Drawn): void {
  gl.deleteBuffer(buffer);
  gl.deleteVertexArray(array);
}

export function draw(gl: WebGL2RenderingContext, drawn: Drawn, first: number, vertices: number): void {
  gl.bindVertexArray(drawn.array);
  gl.drawArrays(gl.TRIANGLES, first, vertices);
}

export function program(gl: WebGL2RenderingContext): WebGLProgram {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]] as const) {
    const shader = gl.createShader(kind);
    if (!shader) throw new Error("WebGL gives no shader");
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? "shader");
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  return made;
}
