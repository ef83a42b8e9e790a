"use strict";(()=>{var b=class{constructor(e,r,n){this.file=e;this.store=r;this.failed=n}bytes=null;get(){return this.bytes??=typeof this.file.content=="string"?this.fetched(this.file.content):new FileReaderSync().readAsArrayBuffer(this.file.content)}fetched(e){let r=new XMLHttpRequest;r.open("GET",e,!1),r.responseType="arraybuffer";try{r.send()}catch{throw this.failed()}let n=r.response;if(r.status!==200||n?.byteLength!==this.file.size)throw this.failed();return this.store?.put(e,new Response(n.slice(0))).catch(()=>{}),n}},p=class t{constructor(e,r,n){this.content=e;this.start=r;this.end=n}static of(e,r,n){return new t(new b(e,r,n),0,e.size)}get size(){return this.end-this.start}slice(e,r){return new t(this.content,this.start+e,Math.min(this.start+r,this.end))}read(){return this.content.get().slice(this.start,this.end)}};function f(t){let{port1:e,port2:r}=new MessageChannel;e.postMessage(null,[t]),e.close(),r.close()}var k="https://linkwork.invalid/snapshot",U="linkwork-snapshot",J=1<<20,x=65536;async function O(t){let e=await t.match(k);if(!e)return null;let r=new Uint8Array(await e.arrayBuffer());return e.headers.get(U)===T(r)?r:null}function C(t,e){let{HEAPU8:r,LDSO:n}=t._module;if(Object.keys(n.loadedLibsByName).some(a=>a!=="__main__"&&!e.includes(a)))return null;let s=t.makeMemorySnapshot(),u=r.length-Math.ceil(t._module._sbrk(0)/x)*x;return s.subarray(0,s.length-u)}async function D(t,e){let r=0,n=new ReadableStream({pull(s){r<e.length?s.enqueue(e.subarray(r,r+=J)):s.close()}});await t.put(k,new Response(n,{headers:{[U]:T(e)}})).catch(()=>{}),f(e.buffer)}function T({length:t}){return`${t} ${navigator.userAgent}`}async function A(t){await t.delete(k)}var j=22,V=30,g=class{constructor(e){this.outside=e}memory=null;async bringIn(){this.memory=await this.outside.arrayBuffer()}leaveOutside(){this.memory&&f(this.memory),this.memory=null}read(e,r){return this.memory?.slice(e,r)??new FileReaderSync().readAsArrayBuffer(this.outside.slice(e,r))}async entries(){let{size:e}=this.outside,r=new DataView(await this.outside.slice(e-j).arrayBuffer()),n=await this.outside.slice(r.getUint32(16,!0),e-j).arrayBuffer(),s=new DataView(n),u=new Map;for(let a=0;a<n.byteLength;){let[l,i]=[s.getUint32(a+24,!0),s.getUint16(a+28,!0)],y=s.getUint32(a+42,!0)+V+i,m=new TextDecoder().decode(new Uint8Array(n,a+46,i));u.set(m,new v(this,y,y+l)),a+=46+i+s.getUint16(a+30,!0)+s.getUint16(a+32,!0)}return u}},v=class t{constructor(e,r,n){this.archive=e;this.start=r;this.end=n}get size(){return this.end-this.start}slice(e,r){return new t(this.archive,this.start+e,Math.min(this.start+r,this.end))}read(){return this.archive.read(this.start,this.end)}};var B="https://linkwork.invalid/",I="/lib/python3.13/site-packages",X=/^numpy\/(_core\/_multiarray_umath|linalg\/_umath_linalg)\..*\.so$/,Z=29,Q=2e4,Y=`
from pyodide.ffi import can_run_sync, run_sync

from linkwork import example_text, loads
from linkwork.app.live.session import BrowserDesk


def solve_task(task, **options):
    from linkwork.synthesis.solvers.solving import solve_task as solve

    return solve(task, **options)


def suggesting():
    from linkwork.synthesis import suggesting as found

    return found
`,ee=`
import gc

desk = BrowserDesk(loads, example_text, lambda event: None, lambda: (), solve_task)
desk.begin("#example=four-bar")
del desk
gc.collect()
`,te=`
from linkwork_page import take, tell, turn


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, solve_task, pause, suggesting)
begin, work = desk.begin, desk.work
`,_=[],M=null,S=!1,d=null;self.onmessage=({data:t})=>{typeof t=="string"?(_.push(t),z()):re(t).catch(async e=>{d?await N(d):self.postMessage({failed:String(e)})})};async function re({engine:t,files:e,late:r,fragment:n,kept:s,store:u,machine:a}){P("Starting Python …",.35);let l=u===null?null:await caches.open(u),i=l&&await O(l);d=i&&l;let y=d&&setTimeout(N,Q,d),m=new g(e["site.zip"]);i||await m.bringIn();let F=await m.entries(),h=new Map([...F].flatMap(([o,w])=>X.test(o)?[[`${I}/${o}`,w]]:[])),{fetch:H,_createPyodideModule:$}=self;self.fetch=async o=>a&&String(o).endsWith(".wasm")?H(a):ne(String(o),e,h),self._createPyodideModule=o=>$(Object.assign(o,{dynamicLibraries:[...h.keys()]}));let c=await loadPyodide({indexURL:B,lockFileContents:t.lock,packageBaseUrl:B,...i?{_loadSnapshot:i}:{_makeSnapshot:l!==null}}),{WORKERFS:E}=c.FS.filesystems;E.reader={readAsArrayBuffer:o=>o.read()};let G=r.map(o=>({name:o.name,data:p.of(o,l,()=>new c.FS.ErrnoError(Z))}));c.FS.mount(E,{blobs:[...[...F].map(([o,w])=>({name:o,data:w})),...G]},I),i?f(i.buffer):(P("Loading the solver …",.7),c.runPython(Y)),l&&!i&&c.runPython(ee);let R=l&&!i?C(c,[...h.keys()]):null,W=()=>_.splice(0);c.registerJsModule("linkwork_page",{take:W,tell:o=>self.postMessage(o),turn:K}),c.runPython(te),y&&clearTimeout(y),P("Solving …",.9);let[q,L]=[c.globals.get("begin"),c.globals.get("work")];q(n,s?.name??"",s?.saved??"",s?.text??""),M="Suspending"in WebAssembly?()=>L.callPromising():()=>Promise.resolve(L()),await z(),m.leaveOutside(),l&&R&&await D(l,R)}async function N(t){await A(t),self.postMessage({again:_})}async function z(){if(!(S||M===null)){S=!0;try{for(;await M();)await K()}catch(t){d&&await A(d),self.postMessage({failed:String(t)})}S=!1}}function K(){return new Promise(t=>{let{port1:e,port2:r}=new MessageChannel;e.onmessage=()=>{e.close(),t()},r.postMessage(null)})}function ne(t,e,r){let n=t.slice(B.length),s=e[n]??r.get(n)?.read();return s?new Response(s):new Response(null,{status:404})}function P(t,e){self.postMessage({doing:t,done:e})}})();
