"use strict";(()=>{function d(t){let{port1:e,port2:n}=new MessageChannel;e.postMessage(null,[t]),e.close(),n.close()}var h="https://linkwork.invalid/snapshot",R="linkwork-snapshot",H=1<<20,x=65536;async function U(t){let e=await t.match(h);if(!e)return null;let n=new Uint8Array(await e.arrayBuffer());return e.headers.get(R)===O(n)?n:null}function F(t,e){let{HEAPU8:n,LDSO:o}=t._module;if(Object.keys(o.loadedLibsByName).some(r=>r!=="__main__"&&!e.includes(r)))return null;let s=t.makeMemorySnapshot(),c=n.length-Math.ceil(t._module._sbrk(0)/x)*x;return s.subarray(0,s.length-c)}async function E(t,e){let n=0,o=new ReadableStream({pull(s){n<e.length?s.enqueue(e.subarray(n,n+=H)):s.close()}});await t.put(h,new Response(o,{headers:{[R]:O(e)}})).catch(()=>{}),d(e.buffer)}function O({length:t}){return`${t} ${navigator.userAgent}`}async function w(t){await t.delete(h)}var L=22,W=30,g=class{constructor(e){this.outside=e}memory=null;async bringIn(){this.memory=await this.outside.arrayBuffer()}leaveOutside(){this.memory&&d(this.memory),this.memory=null}read(e,n){return this.memory?.slice(e,n)??new FileReaderSync().readAsArrayBuffer(this.outside.slice(e,n))}async entries(){let{size:e}=this.outside,n=new DataView(await this.outside.slice(e-L).arrayBuffer()),o=await this.outside.slice(n.getUint32(16,!0),e-L).arrayBuffer(),s=new DataView(o),c=new Map;for(let r=0;r<o.byteLength;){let[i,u]=[s.getUint32(r+24,!0),s.getUint16(r+28,!0)],f=s.getUint32(r+42,!0)+W+u,y=new TextDecoder().decode(new Uint8Array(o,r+46,u));c.set(y,new b(this,f,f+i)),r+=46+u+s.getUint16(r+30,!0)+s.getUint16(r+32,!0)}return c}},b=class t{constructor(e,n,o){this.archive=e;this.start=n;this.end=o}get size(){return this.end-this.start}slice(e,n){return new t(this.archive,this.start+e,Math.min(this.start+n,this.end))}read(){return this.archive.read(this.start,this.end)}};var S="https://linkwork.invalid/",D="/lib/python3.13/site-packages",z=/^numpy\/(_core\/_multiarray_umath|linalg\/_umath_linalg)\..*\.so$/,G=`
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk
`,T=`
import gc

desk = BrowserDesk(loads, example_text, lambda event: None, lambda: ())
desk.begin("#example=four-bar")
del desk
gc.collect()
`,J=`
from linkwork_page import take, tell, turn


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
`,P=[],v=null,k=!1,m=null;self.onmessage=({data:t})=>{typeof t=="string"?(P.push(t),C()):V(t).catch(async e=>{m?(await w(m),self.postMessage({again:P})):self.postMessage({failed:String(e)})})};async function V({engine:t,files:e,fragment:n,kept:o,store:s,machine:c}){A("Starting Python …",.35);let r=s===null?null:await caches.open(s),i=r&&await U(r);m=i&&r;let u=new g(e["site.zip"]);i||await u.bringIn();let f=await u.entries(),y=new Map([...f].flatMap(([a,p])=>z.test(a)?[[`${D}/${a}`,p]]:[])),{fetch:I,_createPyodideModule:K}=self;self.fetch=async a=>c&&String(a).endsWith(".wasm")?I(c):q(String(a),e,y),self._createPyodideModule=a=>K(Object.assign(a,{dynamicLibraries:[...y.keys()]}));let l=await loadPyodide({indexURL:S,lockFileContents:t.lock,packageBaseUrl:S,...i?{_loadSnapshot:i}:{_makeSnapshot:r!==null}}),{WORKERFS:M}=l.FS.filesystems;M.reader={readAsArrayBuffer:a=>a.read()},l.FS.mount(M,{blobs:[...f].map(([a,p])=>({name:a,data:p}))},D),i?d(i.buffer):(A("Loading the solver …",.7),l.runPython(G)),r&&!i&&l.runPython(T);let _=r&&!i?F(l,[...y.keys()]):null,N=()=>P.splice(0);l.registerJsModule("linkwork_page",{take:N,tell:a=>self.postMessage(a),turn:j}),l.runPython(J),A("Solving …",.9);let[$,B]=[l.globals.get("begin"),l.globals.get("work")];$(n,o?.name??"",o?.saved??"",o?.text??""),v="Suspending"in WebAssembly?()=>B.callPromising():()=>Promise.resolve(B()),await C(),u.leaveOutside(),r&&_&&await E(r,_)}async function C(){if(!(k||v===null)){k=!0;try{for(;await v();)await j()}catch(t){m&&await w(m),self.postMessage({failed:String(t)})}k=!1}}function j(){return new Promise(t=>{let{port1:e,port2:n}=new MessageChannel;e.onmessage=()=>{e.close(),t()},n.postMessage(null)})}function q(t,e,n){let o=t.slice(S.length),s=e[o]??n.get(o)?.read();return s?new Response(s):new Response(null,{status:404})}function A(t,e){self.postMessage({doing:t,done:e})}})();
