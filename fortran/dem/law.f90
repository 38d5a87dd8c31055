!> The force at a contact point: a spring without tension, Coulomb friction on a shear spring,
!> and dashpots in parallel with both, proportional to their stiffness.
!>
!> With the normal n from body 1 to body 2, the tangent t, the gap g (negative where bodies overlap), the velocity
!> u' of body 2 relative to body 1 and the length l of joint that the point carries (half of a joint with two
!> points: thesis Eq. 7.12, with k_n its k_j in Pa/m times the depth):
!>
!>    N  = -k_n l (g - g_0)                total, so that no drift can gather (Cundall and Strack 1979)
!>    S += -k_s l u_t' dt,   |S| <= mu N + c l
!>    D  = -beta k l u'                    in both directions: C = beta K at the contacts, thesis Eq. 7.1
!>
!> on body 2, the opposite on body 1. g_0 is 0, or the negative gap at which the spring has no force (`filled` in dem_contacts).
!> mu is the coefficient of friction; cohesion c and tensile strength f_t of
!> mortar (N >= -f_t l) are lost at the first failure in shear or tension. A dashpot acts while the point is closed,
!> in shear while it sticks, and leaves N + D >= 0 (>= -f_t l). beta follows from the damping ratio at a frequency
!> by thesis Eq. 7.17. The normal force does not depend on the sliding (no dilatancy, thesis 7.2).
!>
!> The dashpots are taken implicitly (backward Euler; our own), so that they do not shorten the stable step: with
!> u* the velocity after the step without the new dashpot force and w = n.(M1^-1 + M2^-1) n the velocity that a unit
!> impulse gives,
!>
!>    D = -beta k l (u* + dt w D)   =>   D = -beta k l u* / (1 + beta k l dt w).
!>
!> u* holds what the points before it in the sweep have decided and what those behind it did in the last step. One
!> sweep is one block Gauss-Seidel iteration, warm-started; its fixed point is the implicit equation.
module dem_law
   use common_kinds, only : wp
   use dem_bodies, only : body
   use dem_contacts, only : contact_pair, contact_point, overlap
   use dem_joint, only : joint_law
   implicit none
   private
   public :: apply_pair_law, elastic_energy
   public :: point_frame, point_force, frame_of, find_relative_velocity, hand_over

   !> Unit normal and tangent at a point, and the moments of unit forces along them about both centroids [m]
   type :: point_frame
      real(wp) :: nx = 0.0_wp, ny = 0.0_wp
      real(wp) :: tx = 0.0_wp, ty = 0.0_wp
      real(wp) :: a_n = 0.0_wp, a_t = 0.0_wp
      real(wp) :: b_n = 0.0_wp, b_t = 0.0_wp
   end type point_frame

   !> Forces of a point in this step [N]: of springs and dashpots, and their sums
   type :: point_force
      real(wp) :: spring_n = 0.0_wp, spring_s = 0.0_wp
      real(wp) :: dash_n = 0.0_wp, dash_s = 0.0_wp
      real(wp) :: normal = 0.0_wp, shear = 0.0_wp
   end type point_force

contains

   !> Forces of a pair at its present overlap, added to both bodies; predicted velocities follow
   pure subroutine apply_pair_law(law, kick, drift, now, a, b, pair)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! length of the velocity step [s]
      real(wp), intent(in) :: drift             !! length of the position step before [s]
      type(overlap), intent(in) :: now
      type(body), intent(inout) :: a            !! owner of the reference edge
      type(body), intent(inout) :: b            !! owner of the incident edge
      type(contact_pair), intent(inout) :: pair
      type(joint_law) :: own
      type(point_frame) :: frame
      type(point_force) :: force
      real(wp) :: u_n, u_t
      integer :: i

      own = law
      if (pair%given_up(1) + pair%given_up(2) > 0.0_wp) then
         pair%loss_before = pair%loss_before + pair%given_up * [1.0_wp / law%shear_stiffness, law%normal_stiffness]
         pair%given_up = 0.0_wp
      end if
      do i = 1, 2
         own%damping = now%elastic(i) * law%damping
         associate (point => pair%point(i))
            if (now%gap(i) >= 0.0_wp .or. now%width <= 0.0_wp) then
               ! Mortar that is torn farther than its strength is gone for good.
               point%bonded = point%bonded .and. now%width > 0.0_wp &
                  .and. law%normal_stiffness * now%gap(i) <= law%tension
               if (.not. (point%closed .or. point%bonded)) cycle
            end if
            frame = frame_of(now, i, a, b)
            ! Relative velocity over the position step before: it has moved the springs.
            call find_relative_velocity(frame, b%vx - a%vx, b%vy - a%vy, a%spin, b%spin, u_n, u_t)
            if ((now%gap(i) < 0.0_wp .and. now%width > 0.0_wp) .or. point%bonded) then
               if (.not. point%closed) call close_point(pair, now%width, point)
               call press_point(own, kick, drift, now%gap(i), u_t, frame, a, b, point, force)
            else
               call open_point(law, min(now%gap(i), 0.0_wp), point)
               force = point_force()
            end if
            point%damping_loss = point%damping_loss &
               - 0.5_wp * drift * ((point%dash_n + force%dash_n) * u_n + (point%dash_s + force%dash_s) * u_t)
            call hand_over(kick, drift, frame, point, force, a, b, pair%support_work)
            point%spring_n = force%spring_n
            point%spring_s = force%spring_s
            point%dash_n = force%dash_n
            point%dash_s = force%dash_s
         end associate
      end do
   end subroutine apply_pair_law

   !> Directions and arms at a contact point
   pure function frame_of(now, i, a, b) result(frame)
      type(overlap), intent(in) :: now
      integer, intent(in) :: i                  !! which point
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(point_frame) :: frame
      real(wp) :: ax, ay, bx, by
      frame%tx = now%tx(i)
      frame%ty = now%ty(i)
      frame%nx = frame%ty
      frame%ny = -frame%tx
      ax = now%x(i) - a%x
      ay = now%y(i) - a%y
      bx = now%x(i) - b%x
      by = now%y(i) - b%y
      frame%a_n = ax * frame%ny - ay * frame%nx
      frame%b_n = bx * frame%ny - by * frame%nx
      frame%a_t = ax * frame%ty - ay * frame%tx
      frame%b_t = bx * frame%ty - by * frame%tx
   end function frame_of

   !> Velocity of body 2 relative to body 1 at the point, along its normal and its tangent [m/s]
   pure subroutine find_relative_velocity(frame, ux, uy, spin_a, spin_b, u_n, u_t)
      type(point_frame), intent(in) :: frame
      real(wp), intent(in) :: ux                !! of the centroids [m/s]
      real(wp), intent(in) :: uy
      real(wp), intent(in) :: spin_a            !! [rad/s]
      real(wp), intent(in) :: spin_b
      real(wp), intent(out) :: u_n
      real(wp), intent(out) :: u_t
      u_n = ux * frame%nx + uy * frame%ny + spin_b * frame%b_n - spin_a * frame%a_n
      u_t = ux * frame%tx + uy * frame%ty + spin_b * frame%b_t - spin_a * frame%a_t
   end subroutine find_relative_velocity

   !> Forces of a closed point: springs, then the normal dashpot, then friction on the shear spring and its dashpot
   pure subroutine press_point(law, kick, drift, gap, u_t, frame, a, b, point, force)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: drift             !! [s]
      real(wp), intent(in) :: gap               !! [m]
      real(wp), intent(in) :: u_t               !! slip rate over the position step before [m/s]
      type(point_frame), intent(in) :: frame
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(contact_point), intent(inout) :: point
      type(point_force), intent(out) :: force
      real(wp) :: stiff_n, stiff_s, trial, w_nn, w_nt, w_tt, star_n, star_t

      stiff_n = law%normal_stiffness * point%length
      stiff_s = law%shear_stiffness * point%length
      force%spring_n = -stiff_n * gap                       ! N
      trial = point%spring_s - stiff_s * u_t * drift
      ! Velocity by a unit impulse at the point, along n, t, and across: w.
      w_nn = a%inverse_mass + b%inverse_mass + a%inverse_inertia * frame%a_n**2 + b%inverse_inertia * frame%b_n**2
      w_tt = a%inverse_mass + b%inverse_mass + a%inverse_inertia * frame%a_t**2 + b%inverse_inertia * frame%b_t**2
      w_nt = a%inverse_inertia * frame%a_n * frame%a_t + b%inverse_inertia * frame%b_n * frame%b_t
      call find_relative_velocity(frame, b%px - a%px, b%py - a%py, a%pspin, b%pspin, star_n, star_t)
      call press_normal(law, kick, stiff_n, trial, w_nn, w_nt, star_n, point, force)
      call press_shear(law, kick, stiff_s, trial, w_tt, w_nt, star_t, point, force)
   end subroutine press_point

   !> Normal force of spring and dashpot
   pure subroutine press_normal(law, kick, stiffness, trial, w_nn, w_nt, predicted, point, force)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: stiffness         !! k_n l [N/m]
      real(wp), intent(in) :: trial             !! shear of the spring if it sticks [N]
      real(wp), intent(in) :: w_nn              !! [1/kg]
      real(wp), intent(in) :: w_nt              !! [1/kg]
      real(wp), intent(in) :: predicted         !! normal velocity that the bodies are to have [m/s]
      type(contact_point), intent(in) :: point
      type(point_force), intent(inout) :: force
      real(wp) :: bound, viscous, u, d_n, d_s

      ! u*: the predicted velocity and what the changes of both springs add; then D of the normal dashpot.
      d_n = force%spring_n - point%spring_n
      bound = law%friction * max(force%spring_n + point%dash_n, 0.0_wp)
      if (point%bonded) bound = bound + law%cohesion * point%length
      d_s = max(-bound, min(bound, trial + point%dash_s)) - (point%spring_s + point%dash_s)
      u = predicted + kick * (w_nn * d_n + w_nt * d_s)
      viscous = law%damping * stiffness
      ! The predicted velocity held the old dashpot force: u* is without it.
      force%dash_n = -viscous * (u - kick * w_nn * point%dash_n) / (1.0_wp + viscous * kick * w_nn)
      ! A dashpot never pulls more than the mortar can carry.
      force%normal = force%spring_n + force%dash_n
      force%normal = max(force%normal, merge(-law%tension * point%length, 0.0_wp, point%bonded))
      force%dash_n = force%normal - force%spring_n
   end subroutine press_normal

   !> Shear force of spring and dashpot, now that the normal force is known; mortar may break
   pure subroutine press_shear(law, kick, stiffness, trial, w_tt, w_nt, predicted, point, force)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: stiffness         !! k_s l [N/m]
      real(wp), intent(in) :: trial             !! shear of the spring if it sticks [N]
      real(wp), intent(in) :: w_tt              !! [1/kg]
      real(wp), intent(in) :: w_nt              !! [1/kg]
      real(wp), intent(in) :: predicted         !! tangential velocity that the bodies are to have [m/s]
      type(contact_point), intent(inout) :: point
      type(point_force), intent(inout) :: force
      real(wp) :: bound, viscous, u, d_n, d_s

      d_n = force%normal - (point%spring_n + point%dash_n)
      d_s = trial - point%spring_s
      u = predicted + kick * (w_tt * d_s + w_nt * d_n)
      viscous = law%damping * stiffness
      force%dash_s = -viscous * (u - kick * w_tt * point%dash_s) / (1.0_wp + viscous * kick * w_tt)
      bound = law%friction * force%normal
      if (point%bonded) then
         bound = bound + law%cohesion * point%length
         if (abs(trial) > bound) then
            point%bonded = .false.
            bound = law%friction * force%normal
         end if
      end if
      bound = max(bound, 0.0_wp)
      if (abs(trial) >= bound) then
         force%spring_s = sign(bound, trial)
         force%shear = force%spring_s
         ! Mean force over the step times the slip; the trial force itself was never there.
         point%friction_loss = point%friction_loss &
            + 0.5_wp * (trial - force%spring_s) * (point%spring_s + force%spring_s) / stiffness
      else
         force%spring_s = trial
         force%shear = max(-bound, min(bound, trial + force%dash_s))
      end if
      force%dash_s = force%shear - force%spring_s
   end subroutine press_shear

   !> A point opens: what its springs held is lost. Where it overlaps and yet no stretch is common to the edges, its normal
   !> spring begins anew from there
   pure subroutine open_point(law, gap, point)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: gap               !! of its spring, 0 where none overlaps [m]
      type(contact_point), intent(inout) :: point
      point%friction_loss = point%friction_loss + 0.5_wp * (point%spring_s**2 / law%shear_stiffness &
         + min(point%spring_n, 0.0_wp)**2 / law%normal_stiffness) / point%length
      point%damping_loss = point%damping_loss + 0.5_wp * law%normal_stiffness * point%length * gap**2
      point%filled = point%filled + gap
      point%closed = .false.
   end subroutine open_point

   !> The force of a point to both bodies, or the work it does on a support
   pure subroutine hand_over(kick, drift, frame, point, force, a, b, support_work)
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: drift             !! [s]
      type(point_frame), intent(in) :: frame
      type(contact_point), intent(in) :: point  !! as the step before left it
      type(point_force), intent(in) :: force
      type(body), intent(inout) :: a
      type(body), intent(inout) :: b
      real(wp), intent(inout) :: support_work   !! [J]
      real(wp) :: old_n, old_s, d_n, d_s
      old_n = point%spring_n + point%dash_n
      old_s = point%spring_s + point%dash_s
      d_n = kick * (force%normal - old_n)
      d_s = kick * (force%shear - old_s)
      associate (nx => frame%nx, ny => frame%ny, tx => frame%tx, ty => frame%ty)
         if (a%fixed) then
            support_work = support_work &
               + 0.5_wp * drift * power(a, tx, ty, frame%a_n, frame%a_t, force%normal + old_n, force%shear + old_s)
         else
            call push_body(a, -1.0_wp, nx, ny, tx, ty, frame%a_n, frame%a_t, d_n, d_s, force%normal, force%shear)
         end if
         if (b%fixed) then
            support_work = support_work &
               - 0.5_wp * drift * power(b, tx, ty, frame%b_n, frame%b_t, force%normal + old_n, force%shear + old_s)
         else
            call push_body(b, 1.0_wp, nx, ny, tx, ty, frame%b_n, frame%b_t, d_n, d_s, force%normal, force%shear)
         end if
      end associate
   end subroutine hand_over

   !> Add the force to a body and its change to the body's predicted velocity
   pure subroutine push_body(b, sense, nx, ny, tx, ty, arm_n, arm_t, d_n, d_s, normal, shear)
      type(body), intent(inout) :: b
      real(wp), intent(in) :: sense             !! -1 for the reference body, 1 for the incident one
      real(wp), intent(in) :: nx
      real(wp), intent(in) :: ny
      real(wp), intent(in) :: tx
      real(wp), intent(in) :: ty
      real(wp), intent(in) :: arm_n             !! moment of a unit normal force [m]
      real(wp), intent(in) :: arm_t
      real(wp), intent(in) :: d_n               !! change of the normal impulse [N s]
      real(wp), intent(in) :: d_s
      real(wp), intent(in) :: normal            !! [N]
      real(wp), intent(in) :: shear
      real(wp) :: m
      m = sense * b%inverse_mass
      b%px = b%px + m * (d_n * nx + d_s * tx)
      b%py = b%py + m * (d_n * ny + d_s * ty)
      b%pspin = b%pspin + sense * b%inverse_inertia * (d_n * arm_n + d_s * arm_t)
      b%fx = b%fx + sense * (normal * nx + shear * tx)
      b%fy = b%fy + sense * (normal * ny + shear * ty)
      b%moment = b%moment + sense * (normal * arm_n + shear * arm_t)
      b%touched = .true.
   end subroutine push_body

   !> Power of a contact force at the velocity of a body [W]
   pure function power(b, tx, ty, arm_n, arm_t, normal, shear) result(p)
      type(body), intent(in) :: b
      real(wp), intent(in) :: tx                !! tangent
      real(wp), intent(in) :: ty
      real(wp), intent(in) :: arm_n             !! moment of a unit normal force [m]
      real(wp), intent(in) :: arm_t
      real(wp), intent(in) :: normal            !! [N]
      real(wp), intent(in) :: shear             !! [N]
      real(wp) :: p
      p = normal * (b%vx * ty - b%vy * tx + b%spin * arm_n) &
         + shear * (b%vx * tx + b%vy * ty + b%spin * arm_t)
   end function power

   !> A point closes: it carries half of the common stretch (thesis Eq. 7.12), but never a sliver
   pure subroutine close_point(pair, width, point)
      type(contact_pair), intent(in) :: pair
      real(wp), intent(in) :: width             !! of the overlap [m]
      type(contact_point), intent(inout) :: point
      real(wp), parameter :: sliver = 0.25_wp
      point%closed = .true.
      point%length = 0.5_wp * max(width, sliver * min(pair%reference_length, pair%incident_length))
   end subroutine close_point

   !> Energy in the springs of a pair: (N^2 / k_n + S^2 / k_s) / (2 l), summed over its points, and in corners that crush [J]
   pure function elastic_energy(law, pair) result(energy)
      type(joint_law), intent(in) :: law
      type(contact_pair), intent(in) :: pair
      real(wp) :: energy
      integer :: i
      energy = pair%crushed
      do i = 1, 2
         associate (point => pair%point(i))
            if (.not. point%closed) cycle
            energy = energy + 0.5_wp * (point%spring_n**2 / law%normal_stiffness &
                                        + point%spring_s**2 / law%shear_stiffness) / point%length
         end associate
      end do
   end function elastic_energy

end module dem_law
