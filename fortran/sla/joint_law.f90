!> Coulomb's law of a point of a joint without teeth: a bond that softens in tension and slip, friction that slides in
!> any direction of the joint, crushing.
!>
!> By the jumps dn and s, a vector of the plane of the joint:
!>   across     sigma = E_t dn where it is open, E_c dn where it is closed, secants of the softening laws
!>   along      tau = ks (s - p), |tau| <= c + mu p_n, with the pressure p_n = -sigma (Lourenco and Rots 1997)
!> p is the slip that stays. The strain of the law of the cohesion is its own slip w, of which c(w) / ks is elastic. As
!> p grows by w - c / ks, a step from p_0 has w = |s - p_0| - mu p_n / ks + p_w in closed form, where p_w is w - c / ks
!> at its start. Friction does not dilate.
!>
!> Tension and cohesion are one bond: the same part of both is left, by the progress of their laws.
!>
!> Where histories are frozen, friction has the pressure of the last update: the response has the convex potential of a
!> constant shear strength.
module sla_joint_law
   use common_kinds, only : wp
   use sla_coaxial, only : by_frozen, by_secant, by_tangent
   use sla_sawtooth, only : softening
   implicit none
   private
   public :: joint_material, joint_state, joint_response, joint_rows

   !> Rows of the history of a point: greatest opening and shortening [m], slip of the cohesion's law [m], slip that
   !> stays in both directions [m], pressure of the last update [Pa], energy lost so far [J/m^2], jump across at the last
   !> update [m]
   integer, parameter :: joint_rows = 8
   !> Stiffness along a sliding point in the matrix, over that of one that sticks
   real(wp), parameter :: soft = 1.0e-5_wp
   !> Jumps of a difference, over the greatest jump of the point
   real(wp), parameter :: difference = 1.0e-6_wp

   !> The material of a point
   type :: joint_material
      real(wp) :: kn = 0.0_wp, ks = 0.0_wp     !! [Pa/m]
      real(wp) :: friction = -1.0_wp           !! negative: no sliding
      real(wp) :: floor = 0.0_wp               !! stiffness left over the initial one
      logical :: pulls = .false.               !! it carries tension without limit,
      logical :: cracks = .false.              !! or by a law; else none
      logical :: crushes = .false.
      logical :: coheres = .false.             !! it has a cohesion
      type(softening) :: tension
      type(softening) :: compression
      type(softening) :: cohesion
   contains
      procedure :: progress
   end type joint_material

   !> Response of a point
   type :: joint_state
      real(wp) :: stress(3) = 0.0_wp           !! sigma, tau in both directions [Pa]
      real(wp) :: matrix(3, 3) = 0.0_wp        !! stress by the jumps [Pa/m]
      real(wp) :: energy = 0.0_wp              !! stored; of frozen histories the potential [J/m^2]
      real(wp) :: history(joint_rows) = 0.0_wp
   end type joint_state

contains

   !> How far the bond has gone: 0 whole
   pure function progress(law, history) result(x)
      class(joint_material), intent(in) :: law
      real(wp), intent(in) :: history(joint_rows)
      real(wp) :: x
      x = 0.0_wp
      if (law%cracks) x = law%tension%progress(history(1))
      if (law%coheres) x = max(x, law%cohesion%progress(history(3)))
   end function progress

   !> Stress, stiffness and histories by the jumps. The tangent of what slides, opens or crushes is that of differences
   !> away from the last state: strength, pressure and bond change each other across and along
   pure subroutine joint_response(law, d, kept, history, how, state)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: d(3)                  !! dn, s [m]
      real(wp), intent(in) :: kept(joint_rows)      !! at the start of the step
      real(wp), intent(in) :: history(joint_rows)
      integer, intent(in) :: how                    !! by_... of sla_coaxial
      type(joint_state), intent(out) :: state
      type(joint_state) :: beside
      real(wp) :: step, away(3)
      integer :: i
      call respond_to(law, d, kept, history, how, state)
      if (how /= by_tangent) return
      if (.not. changes(law, d, kept, history, state)) return
      away = d - [kept(8), kept(4:5)]
      step = difference * max(maxval(abs(away)), maxval(abs(d)))
      do i = 1, 3
         if (i == 3 .and. .not. abs(away(3)) > 0.0_wp) cycle     ! in the plane
         associate (h => sign(step, away(i)))
            call respond_to(law, d + h * unit_of(i), kept, history, by_secant, beside)
            state%matrix(:, i) = (beside%stress - state%stress) / h
         end associate
      end do
      do i = 2, 3
         state%matrix(i, i) = state%matrix(i, i) + soft * law%ks
      end do
   end subroutine joint_response

   !> Is the tangent of a point another matrix than its secants: does it slide, or go on along a softening law?
   pure function changes(law, d, kept, history, state) result(yes)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: d(3)                  !! dn, s [m]
      real(wp), intent(in) :: kept(joint_rows)
      real(wp), intent(in) :: history(joint_rows)
      type(joint_state), intent(in) :: state
      logical :: yes
      yes = any(abs(state%history(4:5) - kept(4:5)) > 0.0_wp)
      if (law%cracks) yes = yes .or. d(1) >= max(history(1), law%tension%peak)
      if (law%crushes) yes = yes .or. -d(1) >= max(history(2), law%compression%peak)
   end function changes

   !> Stress, histories and the matrix of secants, of frozen histories that of the potential
   pure subroutine respond_to(law, d, kept, history, how, state)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: d(3)                  !! dn, s [m]
      real(wp), intent(in) :: kept(joint_rows)      !! at the start of the step
      real(wp), intent(in) :: history(joint_rows)
      integer, intent(in) :: how                    !! by_... of sla_coaxial
      type(joint_state), intent(out) :: state
      real(wp) :: pressure
      state%history = history
      state%history(7) = kept(7)
      if (how /= by_frozen) then
         state%history(1) = max(history(1), d(1))
         state%history(2) = max(history(2), -d(1))
      end if
      call respond_across(law, d(1), state)
      pressure = -state%stress(1)
      if (how == by_frozen) pressure = history(6)
      state%history(6) = pressure
      state%history(8) = d(1)
      if (law%friction < 0.0_wp) then
         state%stress(2:3) = law%ks * d(2:3)
         state%matrix(2, 2) = law%ks
         state%matrix(3, 3) = law%ks
         state%energy = state%energy + 0.5_wp * law%ks * dot_product(d(2:3), d(2:3))
         return
      end if
      call respond_along(law, d(2:3), kept, pressure, how, state)
      ! What slip takes from the bond, an open joint has no more
      if (d(1) > 0.0_wp .and. law%coheres .and. law%cracks .and. how /= by_frozen) then
         call respond_across(law, d(1), state)
      end if
      state%energy = state%energy + 0.5_wp * state%stress(1) * d(1)
      state%history(7) = state%history(7) + lost_across(law, d(1), kept, state%history)
   end subroutine respond_to

   !> Stress and secant stiffness across the joint
   pure subroutine respond_across(law, opening, state)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: opening               !! [m]
      type(joint_state), intent(inout) :: state
      real(wp) :: secant
      if (opening <= 0.0_wp) then
         secant = law%kn
         if (law%crushes) secant = max(law%compression%secant(state%history(2)), law%floor * law%kn)
      else
         secant = tensile_secant(law, state%history)
      end if
      state%matrix(1, 1) = secant
      state%stress(1) = secant * opening
   end subroutine respond_across

   !> Secant stiffness of an open joint [Pa/m]
   pure function tensile_secant(law, history) result(secant)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: history(joint_rows)
      real(wp) :: secant
      secant = law%floor * law%kn
      if (law%pulls) secant = law%kn
      if (law%cracks) secant = max(secant, law%tension%secant(law%tension%strain_of(law%progress(history))))
   end function tensile_secant

   !> Stress and stiffness along the joint under a pressure, negative where it is pulled
   pure subroutine respond_along(law, s, kept, pressure, how, state)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: s(2)                  !! [m]
      real(wp), intent(in) :: kept(joint_rows)
      real(wp), intent(in) :: pressure              !! [Pa]
      integer, intent(in) :: how
      type(joint_state), intent(inout) :: state
      real(wp) :: e(2), n(2), way, limit, bond, start, trial
      integer :: i
      e = s - kept(4:5)
      way = norm2(e)
      bond = cohesion_left(law, law%progress(state%history))
      limit = max(bond + law%friction * pressure, 0.0_wp)
      if (law%ks * way <= limit) then
         state%history(4:5) = kept(4:5)
         state%stress(2:3) = law%ks * e
         state%matrix(2, 2) = law%ks
         state%matrix(3, 3) = law%ks
         state%energy = 0.5_wp * law%ks * way**2
         return
      end if
      start = 0.0_wp
      if (how /= by_frozen .and. law%coheres) then
         ! The bond at the start of the step, with what tension has taken since
         start = kept(3)
         if (law%cracks) start = max(start, law%cohesion%strain_of(law%tension%progress(state%history(1))))
         trial = way - law%friction * pressure / law%ks + start - law%cohesion%secant(start) * start / law%ks
         if (trial > state%history(3)) then
            state%history(3) = trial
            bond = cohesion_left(law, law%progress(state%history))
            limit = max(bond + law%friction * pressure, 0.0_wp)
         end if
      end if
      limit = min(limit, law%ks * way)
      n = e / way
      state%stress(2:3) = limit * n
      state%history(4:5) = s - state%stress(2:3) / law%ks
      do i = 1, 2
         state%matrix(1 + i, 1 + i) = limit / way
         if (how == by_frozen) state%matrix(2:3, 1 + i) = state%matrix(2:3, 1 + i) - limit / way * n * n(i)
         state%matrix(1 + i, 1 + i) = state%matrix(1 + i, 1 + i) + soft * law%ks
      end do
      state%energy = 0.5_wp * limit**2 / law%ks
      if (how == by_frozen) state%energy = limit * way - 0.5_wp * limit**2 / law%ks
      way = norm2(state%history(4:5) - kept(4:5))
      state%history(7) = kept(7) + law%friction * mean_pressure(pressure, state%history(8), kept) * way
      if (law%coheres) state%history(7) = state%history(7) + bond_work(law, start, state%history, way)
   end subroutine respond_along

   !> Mean pressure of a step whose jumps go the straight way: a joint that opens or closes presses for a part of it [Pa]
   pure function mean_pressure(pressure, jump, kept) result(mean)
      real(wp), intent(in) :: pressure              !! at the end of the step [Pa]
      real(wp), intent(in) :: jump                  !! across at its end [m]
      real(wp), intent(in) :: kept(joint_rows)
      real(wp) :: mean
      mean = 0.5_wp * (max(pressure, 0.0_wp) + max(kept(6), 0.0_wp))
      if (jump * kept(8) < 0.0_wp) mean = mean * min(jump, kept(8)) / (min(jump, kept(8)) - max(jump, kept(8)))
   end function mean_pressure

   !> Work of the cohesion on a slip that stays [J/m^2]: the area of its law by p, that by w less the elastic part
   pure function bond_work(law, start, history, slip) result(work)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: start                 !! slip of the law at the start of the step [m]
      real(wp), intent(in) :: history(joint_rows)
      real(wp), intent(in) :: slip                  !! [m]
      real(wp) :: work, from, to
      from = max(start, law%cohesion%peak)
      to = max(law%cohesion%strain_of(law%progress(history)), law%cohesion%peak)
      work = law%cohesion%secant(from) * from * slip
      if (to > from) work = min(work, plastic_area(to) - plastic_area(from))

   contains

      pure function plastic_area(w) result(area)
         real(wp), intent(in) :: w
         real(wp) :: area, c
         c = law%cohesion%secant(w) * w
         area = law%cohesion%lost(w) + 0.5_wp * c * (w - c / law%ks)
      end function plastic_area

   end function bond_work

   !> Cohesion at a progress of the bond; a bond of which no cohesion is given holds until it has cracked [Pa]
   pure function cohesion_left(law, x) result(c)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: x
      real(wp) :: c, w
      c = 0.0_wp
      if (law%coheres) then
         w = law%cohesion%strain_of(x)
         c = law%cohesion%secant(w) * w
      else if (law%pulls .or. (law%cracks .and. x <= 0.0_wp)) then
         c = huge(1.0_wp)
      end if
   end function cohesion_left

   !> Energy that opening and crushing have cost since the start of the step [J/m^2]
   pure function lost_across(law, opening, kept, history) result(lost)
      type(joint_material), intent(in) :: law
      real(wp), intent(in) :: opening               !! [m]
      real(wp), intent(in) :: kept(joint_rows)
      real(wp), intent(in) :: history(joint_rows)
      real(wp) :: lost, was, is, reached
      lost = 0.0_wp
      if (law%crushes) lost = law%compression%lost(history(2)) - law%compression%lost(kept(2))
      if (.not. law%cracks .or. opening <= 0.0_wp) return
      was = law%progress(kept)
      is = law%progress(history)
      if (is <= was) return
      associate (from => law%tension%strain_of(was), to => law%tension%strain_of(is))
         ! Along the law as far as the joint opens; what slip takes from the bond, it takes at that opening
         reached = min(max(opening, from), to)
         lost = lost + law%tension%lost(reached) - law%tension%lost(from)
         if (reached < to) lost = lost + 0.5_wp * (law%tension%secant(reached) - law%tension%secant(to)) * opening**2
      end associate
   end function lost_across

   !> Unit vector
   pure function unit_of(i) result(one)
      integer, intent(in) :: i
      real(wp) :: one(3)
      one = 0.0_wp
      one(i) = 1.0_wp
   end function unit_of

end module sla_joint_law
