// The real Connect client for Node against a running gateway, with services and messages known only
// from a descriptor set that is loaded at run time.
//
//   MORTISE_GATEWAY=http://127.0.0.1:PORT MORTISE_DESCRIPTORS=FILE node --test connect_client.test.mjs
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { createFileRegistry, fromBinary } from "@bufbuild/protobuf";
import { FileDescriptorSetSchema } from "@bufbuild/protobuf/wkt";
import { Code, ConnectError, createClient } from "@connectrpc/connect";
import { createConnectTransport } from "@connectrpc/connect-node";

const registry = createFileRegistry(
  fromBinary(FileDescriptorSetSchema, readFileSync(process.env.MORTISE_DESCRIPTORS)),
);

function client(service, useBinaryFormat) {
  const transport = createConnectTransport({
    baseUrl: process.env.MORTISE_GATEWAY,
    httpVersion: "1.1",
    useBinaryFormat,
    jsonOptions: { registry },
  });
  return createClient(registry.getService(`mortise.v1.${service}`), transport);
}

async function failureOf(promise) {
  try {
    await promise;
  } catch (error) {
    return ConnectError.from(error);
  }
  assert.fail("the call should have failed");
}

for (const binary of [false, true]) {
  const format = binary ? "proto" : "JSON";

  test(`unary call (${format})`, async () => {
    let headers;
    let trailers;
    const item = await client("CatalogService", binary).getItem(
      { name: "items/echo" },
      {
        headers: { "x-custom": "blue", "x-request-id": "node-1" },
        onHeader: (received) => (headers = received),
        onTrailer: (received) => (trailers = received),
      },
    );
    assert.equal(item.name, "items/echo");
    assert.equal(item.title, "blue");
    assert.equal(item.revision, 2n ** 60n);
    assert.equal(headers.get("x-request-id"), "node-1");
    assert.equal(trailers.get("x-trail"), "last");
  });

  test(`failure with details (${format})`, async () => {
    const error = await failureOf(client("CatalogService", binary).getItem({ name: "items/missing" }));
    assert.equal(error.code, Code.NotFound);
    assert.match(error.rawMessage, /items\/missing/);
    assert.ok(error.details.length > 0);
    assert.equal(error.details[0].type, "google.rpc.ErrorInfo");
  });

  test(`service that is away (${format})`, async () => {
    const error = await failureOf(client("ParetoService", binary).getFront({ name: "fronts/x" }));
    assert.equal(error.code, Code.Unavailable);
  });

  test(`deadline (${format})`, async () => {
    const error = await failureOf(
      client("CatalogService", binary).getItem({ name: "items/slow" }, { timeoutMs: 100 }),
    );
    assert.equal(error.code, Code.DeadlineExceeded);
  });

  test(`server streaming (${format})`, async () => {
    let offset = 0n;
    const stream = client("CatalogService", binary).exportDesign({ name: "templates/x", revision: 3000000n });
    for await (const chunk of stream) {
      assert.equal(chunk.offset, offset);
      offset += BigInt(chunk.data.length);
    }
    assert.equal(offset, 3000000n);
  });

  test(`failure in the middle of a stream (${format})`, async () => {
    let chunks = 0;
    const error = await failureOf(
      (async () => {
        const stream = client("CatalogService", binary).exportDesign({ name: "templates/broken", revision: 1n });
        for await (const _ of stream) ++chunks;
      })(),
    );
    assert.equal(chunks, 1);
    assert.equal(error.code, Code.FailedPrecondition);
    assert.equal(error.metadata.get("x-trail"), "torn");
  });

  test(`cancelling a stream (${format})`, async () => {
    const controller = new AbortController();
    let chunks = 0;
    const error = await failureOf(
      (async () => {
        const stream = client("CatalogService", binary).exportDesign(
          { name: "templates/endless" },
          { signal: controller.signal },
        );
        for await (const _ of stream) if (++chunks === 3) controller.abort();
      })(),
    );
    assert.equal(error.code, Code.Canceled);
  });

  test(`client streaming (${format})`, async () => {
    async function* chunks() {
      for (let i = 0; i < 10; ++i) yield { data: new Uint8Array(10000) };
    }
    const answer = await client("SimulatorService", binary).uploadBlob(chunks());
    assert.equal(answer.sha256, "100000");
  });
}

test("many calls on kept connections", async () => {
  const catalog = client("CatalogService", false);
  const names = Array.from({ length: 200 }, (_, i) => `items/i${i}`);
  const items = await Promise.all(names.map((name) => catalog.getItem({ name })));
  assert.deepEqual(items.map((item) => item.name), names);
});
