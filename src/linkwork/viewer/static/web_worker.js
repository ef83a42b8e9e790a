"use strict";(()=>{function m(t){let{port1:e,port2:n}=new MessageChannel;e.postMessage(null,[t]),e.close(),n.close()}var w="https://linkwork.invalid/snapshot",U="linkwork-snapshot",W=1<<20,R=65536;async function E(t){let e=await t.match(w);if(!e)return null;let n=new Uint8Array(await e.arrayBuffer());return e.headers.get(U)===L(n)?n:null}function F(t,e){let{HEAPU8:n,LDSO:o}=t._module;if(Object.keys(o.loadedLibsByName).some(r=>r!=="__main__"&&!e.includes(r)))return null;let s=t.makeMemorySnapshot(),c=n.length-Math.ceil(t._module._sbrk(0)/R)*R;return s.subarray(0,s.length-c)}async function O(t,e){let n=0,o=new ReadableStream({pull(s){n<e.length?s.enqueue(e.subarray(n,n+=W)):s.close()}});await t.put(w,new Response(o,{headers:{[U]:L(e)}})).catch(()=>{}),m(e.buffer)}function L({length:t}){return`${t} ${navigator.userAgent}`}async function k(t){await t.delete(w)}var C=22,z=30,g=class{constructor(e){this.outside=e}memory=null;async bringIn(){this.memory=await this.outside.arrayBuffer()}leaveOutside(){this.memory&&m(this.memory),this.memory=null}read(e,n){return this.memory?.slice(e,n)??new FileReaderSync().readAsArrayBuffer(this.outside.slice(e,n))}async entries(){let{size:e}=this.outside,n=new DataView(await this.outside.slice(e-C).arrayBuffer()),o=await this.outside.slice(n.getUint32(16,!0),e-C).arrayBuffer(),s=new DataView(o),c=new Map;for(let r=0;r<o.byteLength;){let[i,d]=[s.getUint32(r+24,!0),s.getUint16(r+28,!0)],f=s.getUint32(r+42,!0)+z+d,y=new TextDecoder().decode(new Uint8Array(o,r+46,d));c.set(y,new b(this,f,f+i)),r+=46+d+s.getUint16(r+30,!0)+s.getUint16(r+32,!0)}return c}},b=class t{constructor(e,n,o){this.archive=e;this.start=n;this.end=o}get size(){return this.end-this.start}slice(e,n){return new t(this.archive,this.start+e,Math.min(this.start+n,this.end))}read(){return this.archive.read(this.start,this.end)}};var S="https://linkwork.invalid/",D="/lib/python3.13/site-packages",G=/^numpy\/(_core\/_multiarray_umath|linalg\/_umath_linalg)\..*\.so$/,J=2e4,V=`
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk


def solve_task(task, **options):
    from linkwork.design.synthesis.solving import solve_task as solve

    return solve(task, **options)
`,q=`
import gc

desk = BrowserDesk(loads, example_text, lambda event: None, lambda: (), solve_task)
desk.begin("#example=four-bar")
del desk
gc.collect()
`,Z=`
from linkwork_page import take, tell, turn


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, solve_task, pause)
begin, work = desk.begin, desk.work
`,_=[],P=null,v=!1,u=null;self.onmessage=({data:t})=>{typeof t=="string"?(_.push(t),I()):Q(t).catch(async e=>{u?await j(u):self.postMessage({failed:String(e)})})};async function Q({engine:t,files:e,fragment:n,kept:o,store:s,machine:c}){A("Starting Python …",.35);let r=s===null?null:await caches.open(s),i=r&&await E(r);u=i&&r;let d=u&&setTimeout(j,J,u),f=new g(e["site.zip"]);i||await f.bringIn();let y=await f.entries(),p=new Map([...y].flatMap(([a,h])=>G.test(a)?[[`${D}/${a}`,h]]:[])),{fetch:N,_createPyodideModule:T}=self;self.fetch=async a=>c&&String(a).endsWith(".wasm")?N(c):X(String(a),e,p),self._createPyodideModule=a=>T(Object.assign(a,{dynamicLibraries:[...p.keys()]}));let l=await loadPyodide({indexURL:S,lockFileContents:t.lock,packageBaseUrl:S,...i?{_loadSnapshot:i}:{_makeSnapshot:r!==null}}),{WORKERFS:M}=l.FS.filesystems;M.reader={readAsArrayBuffer:a=>a.read()},l.FS.mount(M,{blobs:[...y].map(([a,h])=>({name:a,data:h}))},D),i?m(i.buffer):(A("Loading the solver …",.7),l.runPython(V)),r&&!i&&l.runPython(q);let B=r&&!i?F(l,[...p.keys()]):null,$=()=>_.splice(0);l.registerJsModule("linkwork_page",{take:$,tell:a=>self.postMessage(a),turn:K}),l.runPython(Z),d&&clearTimeout(d),A("Solving …",.9);let[H,x]=[l.globals.get("begin"),l.globals.get("work")];H(n,o?.name??"",o?.saved??"",o?.text??""),P="Suspending"in WebAssembly?()=>x.callPromising():()=>Promise.resolve(x()),await I(),f.leaveOutside(),r&&B&&await O(r,B)}async function j(t){await k(t),self.postMessage({again:_})}async function I(){if(!(v||P===null)){v=!0;try{for(;await P();)await K()}catch(t){u&&await k(u),self.postMessage({failed:String(t)})}v=!1}}function K(){return new Promise(t=>{let{port1:e,port2:n}=new MessageChannel;e.onmessage=()=>{e.close(),t()},n.postMessage(null)})}function X(t,e,n){let o=t.slice(S.length),s=e[o]??n.get(o)?.read();return s?new Response(s):new Response(null,{status:404})}function A(t,e){self.postMessage({doing:t,done:e})}})();
