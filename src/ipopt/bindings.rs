//! Made by `make bindings` from the headers of Ipopt 3.11 and 3.14, which agree.

pub type ApplicationReturnStatus = std::ffi::c_int;
#[repr(C)]
#[derive(Debug)]
pub struct IpoptProblemInfo {
    _unused: [u8; 0],
}
pub type IpoptProblem = *mut IpoptProblemInfo;
#[cfg(ipopt_3_11)]
pub type Bool = std::ffi::c_int;
#[cfg(ipopt_3_14)]
pub type Bool = bool;
pub type UserDataPtr = *mut std::ffi::c_void;
pub type Eval_F_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: std::ffi::c_int,
        x: *mut f64,
        new_x: Bool,
        obj_value: *mut f64,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_Grad_F_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: std::ffi::c_int,
        x: *mut f64,
        new_x: Bool,
        grad_f: *mut f64,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_G_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: std::ffi::c_int,
        x: *mut f64,
        new_x: Bool,
        m: std::ffi::c_int,
        g: *mut f64,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_Jac_G_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: std::ffi::c_int,
        x: *mut f64,
        new_x: Bool,
        m: std::ffi::c_int,
        nele_jac: std::ffi::c_int,
        iRow: *mut std::ffi::c_int,
        jCol: *mut std::ffi::c_int,
        values: *mut f64,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_H_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: std::ffi::c_int,
        x: *mut f64,
        new_x: Bool,
        obj_factor: f64,
        m: std::ffi::c_int,
        lambda: *mut f64,
        new_lambda: Bool,
        nele_hess: std::ffi::c_int,
        iRow: *mut std::ffi::c_int,
        jCol: *mut std::ffi::c_int,
        values: *mut f64,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Intermediate_CB = ::std::option::Option<
    unsafe extern "C" fn(
        alg_mod: std::ffi::c_int,
        iter_count: std::ffi::c_int,
        obj_value: f64,
        inf_pr: f64,
        inf_du: f64,
        mu: f64,
        d_norm: f64,
        regularization_size: f64,
        alpha_du: f64,
        alpha_pr: f64,
        ls_trials: std::ffi::c_int,
        user_data: UserDataPtr,
    ) -> Bool,
>;
unsafe extern "C" {
    pub fn CreateIpoptProblem(
        n: std::ffi::c_int,
        x_L: *mut f64,
        x_U: *mut f64,
        m: std::ffi::c_int,
        g_L: *mut f64,
        g_U: *mut f64,
        nele_jac: std::ffi::c_int,
        nele_hess: std::ffi::c_int,
        index_style: std::ffi::c_int,
        eval_f: Eval_F_CB,
        eval_g: Eval_G_CB,
        eval_grad_f: Eval_Grad_F_CB,
        eval_jac_g: Eval_Jac_G_CB,
        eval_h: Eval_H_CB,
    ) -> IpoptProblem;
    pub fn FreeIpoptProblem(ipopt_problem: IpoptProblem);
    pub fn AddIpoptStrOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: *mut std::ffi::c_char,
    ) -> Bool;
    pub fn AddIpoptNumOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: f64,
    ) -> Bool;
    pub fn AddIpoptIntOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: std::ffi::c_int,
    ) -> Bool;
    pub fn SetIntermediateCallback(
        ipopt_problem: IpoptProblem,
        intermediate_cb: Intermediate_CB,
    ) -> Bool;
    pub fn IpoptSolve(
        ipopt_problem: IpoptProblem,
        x: *mut f64,
        g: *mut f64,
        obj_val: *mut f64,
        mult_g: *mut f64,
        mult_x_L: *mut f64,
        mult_x_U: *mut f64,
        user_data: UserDataPtr,
    ) -> ApplicationReturnStatus;
}
