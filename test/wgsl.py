"""python3 wgsl.py FOLDER RATIO: compiles FOLDER/plain.wgsl and runs FOLDER/code.wgsl on FOLDER/questions in a browser's WebGPU; the
answers, RATIO times as many bytes, into FOLDER/answers.

Exits with status 77 without Chromium or WebGPU; standard output says which is missing."""
import base64
import os
import sys

from support.chromium import Chromium, program

folder, ratio = sys.argv[1], int(sys.argv[2])


def read(name):
    with open(os.path.join(folder, name), "rb") as file:
        return file.read()


if not program():
    print("no Chromium")
    sys.exit(77)
page = os.path.join(folder, "page.html")
with open(page, "w") as file:
    file.write("<!doctype html>")
chromium = Chromium(["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"])
chromium.open(page)
if not chromium.run("navigator.gpu ? navigator.gpu.requestAdapter().then((adapter) => adapter !== null) : false"):
    print("a Chromium without WebGPU")
    sys.exit(77)
questions = read("questions")
answer = chromium.run("""(async (plain, code, questions, bytes) => {
    const device = await (await navigator.gpu.requestAdapter()).requestDevice();
    const compile = async (code) => {
        const module = device.createShaderModule({ code });
        for (const fault of (await module.getCompilationInfo()).messages) throw Error(`${fault.lineNum}: ${fault.message}`);
        return module;
    };
    await compile(plain);
    const module = await compile(code);
    const pipeline = device.createComputePipeline({ layout: "auto", compute: { module, entryPoint: "main" } });
    const data = Uint8Array.from(atob(questions), (c) => c.charCodeAt(0));
    const { STORAGE, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
    const input = device.createBuffer({ size: data.length, usage: STORAGE | COPY_DST });
    const output = device.createBuffer({ size: bytes, usage: STORAGE | COPY_SRC });
    const read = device.createBuffer({ size: bytes, usage: MAP_READ | COPY_DST });
    device.queue.writeBuffer(input, 0, data);
    const encoder = device.createCommandEncoder(), pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries:
        [input, output].map((buffer, binding) => ({ binding, resource: { buffer } })) }));
    pass.dispatchWorkgroups(data.length / 48 / 64);
    pass.end();
    encoder.copyBufferToBuffer(output, 0, read, 0, bytes);
    device.queue.submit([encoder.finish()]);
    await read.mapAsync(GPUMapMode.READ);
    const answers = new Uint8Array(read.getMappedRange());
    let text = "";
    for (let i = 0; i < bytes; i += 8190) text += btoa(String.fromCharCode(...answers.subarray(i, i + 8190)));
    return text;
})""" + f"({read('plain.wgsl').decode()!r}, {read('code.wgsl').decode()!r}, '{base64.b64encode(questions).decode()}', {ratio * len(questions)})")
with open(os.path.join(folder, "answers"), "wb") as file:
    file.write(base64.b64decode(answer))
chromium.close()
