!> The force at a contact point: a spring that knows no tension, Coulomb friction on a shear spring,
!> and dashpots in parallel with both, proportional to their stiffness.
!>
!> With the normal n from body 1 to body 2, the tangent t, the gap g (negative where bodies overlap), the velocity
!> u' of body 2 relative to body 1 and the length l of joint that the point carries (half of a joint with two
!> points: thesis Eq. 7.12, with k_n its k_j in Pa/m times the depth):
!>
!>    N  = -k_n l g                        total, so that no drift can gather (Cundall and Strack 1979)
!>    S += -k_s l u_t' dt,   |S| <= mu N + c l
!>    D  = -beta k l u'                    in both directions: C = beta K at the contacts, thesis Eq. 7.1
!>
!> on body 2, the opposite on body 1. mu is the coefficient of friction; cohesion c and tensile strength f_t of
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
   implicit none
   private
   public :: joint_law, act, elastic_energy

   !> A type of joint; stiffnesses per area times depth
   type :: joint_law
      real(wp) :: normal_stiffness = 0.0_wp     !! [N/m per m of joint]
      real(wp) :: shear_stiffness = 0.0_wp      !! [N/m per m of joint]
      real(wp) :: friction = 0.0_wp             !! coefficient
      real(wp) :: cohesion = 0.0_wp             !! of a bonded joint [N per m of joint]
      real(wp) :: tension = 0.0_wp              !! strength of a bonded joint [N per m of joint]
      real(wp) :: damping = 0.0_wp              !! stiffness-proportional, beta [s]
   end type joint_law

contains

   !> Forces of a pair at its present overlap, added to both bodies; predicted velocities follow
   pure subroutine act(law, kick, drift, now, a, b, it)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! length of the velocity step [s]
      real(wp), intent(in) :: drift             !! length of the position step before [s]
      type(overlap), intent(in) :: now
      type(body), intent(inout) :: a            !! owner of the reference edge
      type(body), intent(inout) :: b            !! owner of the incident edge
      type(contact_pair), intent(inout) :: it
      integer :: i
      real(wp) :: nx, ny, tx, ty, ax, ay, bx, by, a_n, a_t, b_n, b_t, w_nn, w_nt, w_tt
      real(wp) :: ux, uy, u_n, u_t, old_n, old_s, dash_n, dash_s, spring_n, spring_s, stiff_n, stiff_s
      real(wp) :: trial, bound, viscous, normal, shear, d_n, d_s

      do i = 1, 2
         associate (point => it%point(i))
            if (now%gap(i) >= 0.0_wp .or. now%width <= 0.0_wp) then
               ! Mortar that is torn farther than its strength is gone for good.
               point%bonded = point%bonded .and. now%width > 0.0_wp &
                  .and. law%normal_stiffness * now%gap(i) <= law%tension
               if (.not. (point%closed .or. point%bonded)) cycle
            end if
            tx = now%tx(i)
            ty = now%ty(i)
            nx = ty
            ny = -tx
            ax = now%x(i) - a%x
            ay = now%y(i) - a%y
            bx = now%x(i) - b%x
            by = now%y(i) - b%y
            a_n = ax * ny - ay * nx
            b_n = bx * ny - by * nx
            a_t = ax * ty - ay * tx
            b_t = bx * ty - by * tx
            ! Relative velocity over the position step before: it has moved the springs.
            ux = b%vx - a%vx
            uy = b%vy - a%vy
            u_n = ux * nx + uy * ny + b%spin * b_n - a%spin * a_n
            u_t = ux * tx + uy * ty + b%spin * b_t - a%spin * a_t
            old_n = point%spring_n + point%dash_n
            old_s = point%spring_s + point%dash_s
            if ((now%gap(i) < 0.0_wp .and. now%width > 0.0_wp) .or. point%bonded) then
               if (.not. point%closed) call close_point(it, now%width, point)
               stiff_n = law%normal_stiffness * point%length
               stiff_s = law%shear_stiffness * point%length
               spring_n = -stiff_n * now%gap(i)                      ! N
               trial = point%spring_s - stiff_s * u_t * drift

               ! Velocity by a unit impulse at the point, along n, t, and across: w.
               w_nn = a%inverse_mass + b%inverse_mass + a%inverse_inertia * a_n**2 + b%inverse_inertia * b_n**2
               w_tt = a%inverse_mass + b%inverse_mass + a%inverse_inertia * a_t**2 + b%inverse_inertia * b_t**2
               w_nt = a%inverse_inertia * a_n * a_t + b%inverse_inertia * b_n * b_t
               ! u*: the predicted velocity and what the changes of both springs add; then D of the normal dashpot.
               ux = b%px - a%px
               uy = b%py - a%py
               d_n = spring_n - point%spring_n
               bound = law%friction * max(spring_n + point%dash_n, 0.0_wp)
               if (point%bonded) bound = bound + law%cohesion * point%length
               d_s = max(-bound, min(bound, trial + point%dash_s)) - old_s
               dash_n = ux * nx + uy * ny + b%pspin * b_n - a%pspin * a_n + kick * (w_nn * d_n + w_nt * d_s)
               viscous = law%damping * stiff_n
               ! The predicted velocity held the old dashpot force: u* is without it.
               dash_n = -viscous * (dash_n - kick * w_nn * point%dash_n) / (1.0_wp + viscous * kick * w_nn)
               ! A dashpot never pulls more than the mortar can bear.
               normal = spring_n + dash_n
               normal = max(normal, merge(-law%tension * point%length, 0.0_wp, point%bonded))
               dash_n = normal - spring_n
               ! The same for the shear dashpot, now that the normal force is known.
               d_n = normal - old_n
               d_s = trial - point%spring_s
               dash_s = ux * tx + uy * ty + b%pspin * b_t - a%pspin * a_t + kick * (w_tt * d_s + w_nt * d_n)
               viscous = law%damping * stiff_s
               dash_s = -viscous * (dash_s - kick * w_tt * point%dash_s) / (1.0_wp + viscous * kick * w_tt)
               bound = law%friction * normal
               if (point%bonded) then
                  bound = bound + law%cohesion * point%length
                  if (abs(trial) > bound) then
                     point%bonded = .false.
                     bound = law%friction * normal
                  end if
               end if
               bound = max(bound, 0.0_wp)
               if (abs(trial) >= bound) then
                  spring_s = sign(bound, trial)
                  shear = spring_s
                  ! Mean force over the step times the slip; the trial force itself was never there.
                  point%friction_loss = point%friction_loss &
                     + 0.5_wp * (trial - spring_s) * (point%spring_s + spring_s) / stiff_s
               else
                  spring_s = trial
                  shear = max(-bound, min(bound, trial + dash_s))
               end if
               dash_s = shear - spring_s
            else   ! the point opens: what its springs held is lost
               point%friction_loss = point%friction_loss + 0.5_wp * (point%spring_s**2 / law%shear_stiffness &
                  + min(point%spring_n, 0.0_wp)**2 / law%normal_stiffness) / point%length
               point%closed = .false.
               spring_n = 0.0_wp
               spring_s = 0.0_wp
               dash_n = 0.0_wp
               dash_s = 0.0_wp
               normal = 0.0_wp
               shear = 0.0_wp
            end if
            point%damping_loss = point%damping_loss &
               - 0.5_wp * drift * ((point%dash_n + dash_n) * u_n + (point%dash_s + dash_s) * u_t)
            d_n = kick * (normal - old_n)
            d_s = kick * (shear - old_s)
            if (a%fixed) then
               it%support_work = it%support_work &
                  + 0.5_wp * drift * power(a, tx, ty, a_n, a_t, normal + old_n, shear + old_s)
            else
               call push(a, -1.0_wp, nx, ny, tx, ty, a_n, a_t, d_n, d_s, normal, shear)
            end if
            if (b%fixed) then
               it%support_work = it%support_work &
                  - 0.5_wp * drift * power(b, tx, ty, b_n, b_t, normal + old_n, shear + old_s)
            else
               call push(b, 1.0_wp, nx, ny, tx, ty, b_n, b_t, d_n, d_s, normal, shear)
            end if
            point%spring_n = spring_n
            point%spring_s = spring_s
            point%dash_n = dash_n
            point%dash_s = dash_s
         end associate
      end do
   end subroutine act

   !> Add the force to a body and its change to the body's predicted velocity
   pure subroutine push(it, sense, nx, ny, tx, ty, arm_n, arm_t, d_n, d_s, normal, shear)
      type(body), intent(inout) :: it
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
      m = sense * it%inverse_mass
      it%px = it%px + m * (d_n * nx + d_s * tx)
      it%py = it%py + m * (d_n * ny + d_s * ty)
      it%pspin = it%pspin + sense * it%inverse_inertia * (d_n * arm_n + d_s * arm_t)
      it%fx = it%fx + sense * (normal * nx + shear * tx)
      it%fy = it%fy + sense * (normal * ny + shear * ty)
      it%moment = it%moment + sense * (normal * arm_n + shear * arm_t)
      it%touched = .true.
   end subroutine push

   !> Power of a contact force at the velocity of a body [W]
   pure function power(it, tx, ty, arm_n, arm_t, normal, shear) result(p)
      type(body), intent(in) :: it
      real(wp), intent(in) :: tx                !! tangent
      real(wp), intent(in) :: ty
      real(wp), intent(in) :: arm_n             !! moment of a unit normal force [m]
      real(wp), intent(in) :: arm_t
      real(wp), intent(in) :: normal            !! [N]
      real(wp), intent(in) :: shear             !! [N]
      real(wp) :: p
      p = normal * (it%vx * ty - it%vy * tx + it%spin * arm_n) &
         + shear * (it%vx * tx + it%vy * ty + it%spin * arm_t)
   end function power

   !> A point closes: it carries half of the common stretch (thesis Eq. 7.12), but never a sliver
   pure subroutine close_point(it, width, point)
      type(contact_pair), intent(in) :: it
      real(wp), intent(in) :: width             !! of the overlap [m]
      type(contact_point), intent(inout) :: point
      real(wp), parameter :: sliver = 0.25_wp
      point%closed = .true.
      point%length = 0.5_wp * max(width, sliver * min(it%reference_length, it%incident_length))
   end subroutine close_point

   !> Energy in the springs of a pair: (N^2 / k_n + S^2 / k_s) / (2 l), summed over its points [J]
   pure function elastic_energy(law, it) result(energy)
      type(joint_law), intent(in) :: law
      type(contact_pair), intent(in) :: it
      real(wp) :: energy
      integer :: i
      energy = 0.0_wp
      do i = 1, 2
         associate (point => it%point(i))
            if (.not. point%closed) cycle
            energy = energy + 0.5_wp * (point%spring_n**2 / law%normal_stiffness &
                                        + point%spring_s**2 / law%shear_stiffness) / point%length
         end associate
      end do
   end function elastic_energy

end module dem_law
